#include "trainer/train/features.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "runtime/basis/error.h"
#include "runtime/cpu/kernels.h"
#include "runtime/rig.h"
#include "trainer/train/parallel.h"

namespace bodyopt {

FrameRows raw_features(const Basis& basis, const std::vector<Pose>& poses) {
  const std::size_t joints = joint_feature_count(basis.skeleton), strains = basis.strain.fibre_count(),
                    controls = basis.residual.controls.size();
  FrameRows raw(static_cast<Eigen::Index>(poses.size()), static_cast<Eigen::Index>(joints + strains + controls));
  parallel_for("features", poses.size(), [&](std::size_t f) {
    const RigFrame rig = pose_rig(basis.skeleton, poses[f]);
    if (!poses[f].controls.empty() && poses[f].controls.size() != controls) {
      throw Error(ErrorKind::mismatch, "a pose has " + std::to_string(poses[f].controls.size()) +
                                           " control values, others have " + std::to_string(controls) +
                                           ": all takes of a dataset need the same controls");
    }
    std::vector<float> positions(3 * basis.strain.vertices.size()), lengths(strains);
    cpu::strain_skin(basis.ddm, basis.strain, static_cast<std::uint32_t>(basis.skeleton.size()), rig.skinning,
                     positions);
    cpu::strain_measure(basis.strain, positions, lengths);
    float* row = raw.row(static_cast<Eigen::Index>(f)).data();
    std::fill(row, row + raw.cols(), 0.0f);
    row = std::copy(rig.joint_features.begin(), rig.joint_features.end(), row);
    row = std::copy(lengths.begin(), lengths.end(), row);
    std::copy(poses[f].controls.begin(), poses[f].controls.end(), row);
  });
  return raw;
}

std::vector<FeatureRange> feature_ranges(const FrameRows& raw) {
  std::vector<FeatureRange> ranges;
  for (Eigen::Index k = 0; k < raw.cols(); ++k) {
    const Eigen::VectorXd column = raw.col(k).cast<double>();
    const double low = column.minCoeff(), high = column.maxCoeff(), mean = column.mean();
    const double deviation = std::sqrt((column.array() - mean).square().mean());
    const double margin = 0.01 * (high - low);
    ranges.push_back({static_cast<float>(low - margin), static_cast<float>(high + margin), static_cast<float>(mean),
                      static_cast<float>(1 / std::max(deviation, 1e-3))});
  }
  return ranges;
}

FrameRows standardised_features(const Basis& basis, const FrameRows& raw) {
  const std::size_t joints = joint_feature_count(basis.skeleton), strains = basis.strain.fibre_count(),
                    controls = basis.residual.controls.size();
  FrameRows result(raw.rows(), raw.cols());
  std::vector<float> excess(static_cast<std::size_t>(raw.cols()));
  for (Eigen::Index f = 0; f < raw.rows(); ++f) {
    const std::span<const float> row(raw.row(f).data(), static_cast<std::size_t>(raw.cols()));
    cpu::residual_features(basis.residual, row.first(joints), row.subspan(joints, strains), row.last(controls), 1,
                           {result.row(f).data(), row.size()}, excess);
  }
  return result;
}

}  // namespace bodyopt
