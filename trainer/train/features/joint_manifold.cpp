#include "trainer/train/features/joint_manifold.h"

#include <algorithm>

#include "base/linear_algebra.h"
#include "base/parallel.h"
#include "runtime/host/rig.h"

namespace bodyopt {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kLeastShown = 0.03;  // radians: an axis along which training moves less was not shown
constexpr double kUsualShare = 0.99;  // of the frames that cross-validation holds out

// Of every joint that has features: itself, its parent and its children, as places in feature_joints().
std::vector<std::vector<std::uint32_t>> neighbourhoods(const Skeleton& skeleton) {
  const std::vector<std::uint32_t> joints = feature_joints(skeleton);
  std::vector<std::vector<std::uint32_t>> result(joints.size());
  for (std::uint32_t a = 0; a < joints.size(); ++a) {
    for (std::uint32_t b = 0; b < joints.size(); ++b) {
      const bool near = a == b || skeleton.joints[joints[a]].parent == static_cast<int>(joints[b]) ||
                        skeleton.joints[joints[b]].parent == static_cast<int>(joints[a]);
      if (near) result[a].push_back(b);
    }
  }
  return result;
}

std::vector<Index> columns_of(const std::vector<std::uint32_t>& joints) {
  std::vector<Index> columns;
  for (const std::uint32_t joint : joints) {
    for (Index k = 0; k < 9; ++k) columns.push_back(9 * Index{joint} + k);
  }
  return columns;
}

// Rows are orthonormal axes along which the frames (N x F) hardly move.
MatrixXd axes_not_shown(const MatrixXd& frames) {
  const MatrixXd spread = frames.transpose() * frames / static_cast<double>(std::max<Index>(1, frames.rows()));
  const SymmetricEigen eigen = symmetric_eigen(spread);
  const Index count = (eigen.values.array() < kLeastShown * kLeastShown).count();
  return eigen.vectors.leftCols(count).transpose();
}

// What the nine columns of each row lie outside the range that others span with rest, squared.
Eigen::VectorXd squared_excess(const MatrixXd& frames, const MatrixXd& shown) {
  const Eigen::RowVectorXd low = shown.colwise().minCoeff().cwiseMin(0), high = shown.colwise().maxCoeff().cwiseMax(0);
  const MatrixXd below = (-(frames.rowwise() - low)).cwiseMax(0), above = (frames.rowwise() - high).cwiseMax(0);
  return (below + above).rowwise().squaredNorm();
}

struct JointFrames {
  MatrixXd near;  // N x 9 neighbours
  MatrixXd own;   // N x 9
};

// How far each of the frames stands off what others showed, radians squared.
Eigen::VectorXd squared_distance(const JointFrames& frames, const JointFrames& shown) {
  return (frames.near * axes_not_shown(shown.near).transpose()).rowwise().squaredNorm() +
         squared_excess(frames.own, shown.own);
}

JointFrames some_of(const JointFrames& frames, const std::vector<Index>& rows) {
  return {frames.near(rows, Eigen::all), frames.own(rows, Eigen::all)};
}

double tolerance_of(const JointFrames& frames, const std::vector<int>& folds) {
  std::vector<double> distances;
  const int last = *std::max_element(folds.begin(), folds.end());
  for (int fold = 0; fold <= last; ++fold) {
    std::vector<Index> held_out, others;
    for (std::size_t n = 0; n < folds.size(); ++n) {
      if (folds[n] < 0) continue;
      (folds[n] == fold ? held_out : others).push_back(static_cast<Index>(n));
    }
    const Eigen::VectorXd some = squared_distance(some_of(frames, held_out), some_of(frames, others));
    distances.insert(distances.end(), some.begin(), some.end());
  }
  const auto usual =
      distances.begin() +
      static_cast<std::ptrdiff_t>(kUsualShare * static_cast<double>(std::max<std::size_t>(1, distances.size()) - 1));
  std::nth_element(distances.begin(), usual, distances.end());
  return std::max(squared_distance(frames, frames).maxCoeff(), distances.empty() ? 0 : *usual);
}

}  // namespace

FadeTable joint_manifold(const Skeleton& skeleton, const RawFeatures& raw, const std::vector<int>& folds) {
  const std::vector<std::vector<std::uint32_t>> near = neighbourhoods(skeleton);
  std::vector<MatrixXd> directions(near.size());
  FadeTable table;
  table.tolerance.resize(near.size());
  parallel_for(near.size(), [&](std::size_t j) {
    const JointFrames frames{raw(Eigen::all, columns_of(near[j])).cast<double>(),
                             raw.middleCols(9 * static_cast<Index>(j), 9).cast<double>()};
    directions[j] = axes_not_shown(frames.near);
    table.tolerance[j] = static_cast<float>(tolerance_of(frames, folds));
  });
  table.joint_begin = table.direction_begin = {0};
  for (std::size_t j = 0; j < near.size(); ++j) {
    table.joints.insert(table.joints.end(), near[j].begin(), near[j].end());
    for (Index row = 0; row < directions[j].rows(); ++row) {
      for (Index k = 0; k < directions[j].cols(); ++k) {
        table.directions.push_back(static_cast<float>(directions[j](row, k)));
      }
    }
    table.joint_begin.push_back(static_cast<std::uint32_t>(table.joints.size()));
    table.direction_begin.push_back(table.direction_begin.back() + static_cast<std::uint32_t>(directions[j].rows()));
  }
  return table;
}

std::vector<double> joint_turns(const RawFeatures& raw, std::size_t joint_count) {
  std::vector<double> turns;
  for (std::size_t j = 0; j < joint_count; ++j) {
    const auto own = raw.middleCols(9 * static_cast<Index>(j), 9).cast<double>();
    turns.push_back(own.squaredNorm() / static_cast<double>(std::max<Index>(1, raw.rows())));
  }
  return turns;
}

}  // namespace bodyopt
