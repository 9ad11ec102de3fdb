#include "trainer/train/data/contradictions.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace bodyopt {
namespace {

using Eigen::Index;

// Deviations by which features of one pose may differ: what lies so near differs by rounding.
constexpr double kSame = 1e-3;
// Distances that the pose may explain: a part of the character's size, and of the region's motion.
constexpr double kPlausibleOfSize = 1.0 / 900, kPlausibleOfMotion = 0.05;

// Any direction in which frames that differ hardly ever coincide.
Eigen::VectorXd some_direction(Index count) {
  return Eigen::VectorXd::NullaryExpr(count, [](Index k) { return std::cos(1.7 * static_cast<double>(k)); });
}

// Root mean square over the region of a displacement.
double size_in(const RegionWeights& region, const Eigen::RowVectorXf& row) {
  const auto square = [&](std::size_t k) {
    return double{row.segment<3>(3 * Index{region.vertices[k]}).squaredNorm()};
  };
  return std::sqrt(mean_over(region, square));
}

}  // namespace

std::vector<FramePair> frames_of_one_pose(const Eigen::MatrixXd& features) {
  // Frames are compared with those beside them along one direction only.
  const Eigen::VectorXd direction = some_direction(features.cols());
  const Eigen::VectorXd along = features * direction;
  const double reach = kSame * direction.cwiseAbs().sum();
  const Eigen::MatrixXd columns = features.transpose();
  std::vector<Index> order(static_cast<std::size_t>(features.rows()));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return along[a] < along[b]; });

  std::vector<std::vector<Index>> poses;  // frames of each; the first one found stands for it
  for (const Index frame : order) {
    auto pose = poses.rbegin();
    while (pose != poses.rend() && along[frame] - along[pose->front()] <= reach &&
           !((columns.col(frame) - columns.col(pose->front())).array().abs() <= kSame).all()) {
      ++pose;
    }
    if (pose != poses.rend() && along[frame] - along[pose->front()] <= reach) {
      pose->push_back(frame);
    } else {
      poses.push_back({frame});
    }
  }

  std::vector<FramePair> pairs;
  for (const std::vector<Index>& pose : poses) {
    const Index first = *std::min_element(pose.begin(), pose.end());
    for (const Index frame : pose) {
      if (frame != first) pairs.push_back({static_cast<std::size_t>(first), static_cast<std::size_t>(frame)});
    }
  }
  std::ranges::sort(pairs, {}, &FramePair::second);
  return pairs;
}

std::vector<Contradiction> contradictions(const std::vector<FramePair>& pairs, const Displacements& displacements,
                                          const RegionWeights& region, double size, double motion) {
  std::vector<Contradiction> found;
  const double plausible = std::max(kPlausibleOfSize * size, kPlausibleOfMotion * motion);
  for (const FramePair& pair : pairs) {
    const Eigen::RowVectorXf difference =
        displacements.row(static_cast<Index>(pair.first)) - displacements.row(static_cast<Index>(pair.second));
    const double distance = size_in(region, difference);
    if (distance > plausible) found.push_back({pair, distance, region.name});
  }
  return found;
}

}  // namespace bodyopt
