#include "trainer/modifiers/learn_breath.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>

#include "geometry/closed_skin.h"
#include "runtime/core/error.h"
#include "runtime/modifiers/breath_shapes.h"

namespace bodyopt {
namespace {

constexpr double kLeastGain = 1e-5;  // of the volume: less is noise
constexpr double kLeastShare = 0.5;  // that each shape must have of all frames together

Eigen::VectorXd volumes_of(const Positions& rest, const Triangles& triangles, const std::vector<Positions>& offsets) {
  Eigen::VectorXd volumes(static_cast<Eigen::Index>(offsets.size()));
  for (std::size_t n = 0; n < offsets.size(); ++n) {
    volumes[static_cast<Eigen::Index>(n)] = enclosed_volume(rest + offsets[n], triangles);
  }
  return volumes;
}

// N x (1 + kBreathShapes): 1, for the skin that is breathed out, and how much of each shape a frame shows.
Eigen::MatrixXd shares_of(const Eigen::VectorXd& filled) {
  const Eigen::Index frames = filled.size();
  Eigen::MatrixXd shares(frames, 1 + static_cast<Eigen::Index>(kBreathShapes));
  for (Eigen::Index n = 0; n < frames; ++n) {
    const bool comes_in = filled[std::min(n + 1, frames - 1)] > filled[std::max<Eigen::Index>(n - 1, 0)];
    const std::array<double, kBreathShapes> own = breath_shapes(filled[n], comes_in);
    shares(n, 0) = 1;
    for (std::size_t k = 0; k < kBreathShapes; ++k) shares(n, static_cast<Eigen::Index>(k) + 1) = own[k];
  }
  return shares;
}

}  // namespace

LearntBreath learn_breath(const Positions& rest, const Triangles& triangles, const std::vector<Positions>& offsets,
                          const std::string& place) {
  const auto refuse = [&](const std::string& what) {
    throw Error(ErrorKind::mismatch, place + ": the take " + what +
                                         ": expected frames of a whole breath, in and out, of a skin that is closed");
  };
  if (offsets.empty()) refuse("has no frames");
  const Eigen::VectorXd volumes = volumes_of(rest, triangles, offsets);
  const double empty = volumes.minCoeff(), gained = volumes.maxCoeff() - empty;
  if (!(gained > kLeastGain * std::abs(empty))) refuse("does not breathe: its skin gains no volume");
  const Eigen::MatrixXd shares = shares_of((volumes.array() - empty) / gained);
  if (!(shares.colwise().sum().minCoeff() > kLeastShare)) refuse("shows a part of a breath only");
  const Eigen::Index vertices = rest.rows();
  Eigen::MatrixXd frames(shares.rows(), 3 * vertices);
  for (std::size_t n = 0; n < offsets.size(); ++n) {
    frames.row(static_cast<Eigen::Index>(n)) = offsets[n].reshaped<Eigen::RowMajor>().transpose();
  }
  const Eigen::MatrixXd fitted = shares.colPivHouseholderQr().solve(frames);
  LearntBreath breath;
  breath.litres = 1e3 * gained;
  for (Eigen::Index k = 1; k < fitted.rows(); ++k) {
    breath.shapes.push_back(fitted.row(k).reshaped<Eigen::RowMajor>(vertices, 3));
  }
  return breath;
}

}  // namespace bodyopt
