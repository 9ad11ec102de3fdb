#include "trainer/curate/pose_map.h"

#include <cmath>
#include <numbers>

#include "base/linear_algebra.h"
#include "base/parallel.h"
#include "runtime/host/rig.h"
#include "trainer/curate/pose_space.h"

namespace bodyopt {
namespace {

using Eigen::Index;

constexpr double kDegrees = 180 / std::numbers::pi;

// N x F, degrees from the bind pose, centred.
Eigen::MatrixXd features_of(const PoseDatabase& database, const SkinPart& part) {
  Pose rest = bind_pose(database.character.skeleton);
  rest.controls.assign(database.controls.size(), 0);
  Eigen::MatrixXd features(static_cast<Index>(database.frames.size()), pose_difference(rest, rest, part.joints).size());
  for (Index n = 0; n < features.rows(); ++n) {
    features.row(n) =
        kDegrees * pose_difference(rest, database.frames[static_cast<std::size_t>(n)].pose, part.joints).transpose();
  }
  if (features.rows() > 0) features.rowwise() -= features.colwise().mean().eval();
  return features;
}

}  // namespace

double pose_spread(const PoseDatabase& database, const SkinPart& part) {
  const Eigen::MatrixXd features = features_of(database, part);
  return features.norm() / std::sqrt(static_cast<double>(std::max<Index>(1, features.rows())));
}

PoseMap pose_map(const PoseDatabase& database, const SkinPart& part, double degrees) {
  const std::size_t count = database.frames.size();
  PoseMap map;
  map.places.setZero(static_cast<Index>(count), 2);
  map.neighbours.assign(count, 0);
  const Eigen::MatrixXd features = features_of(database, part);
  if (features.rows() == 0 || features.cols() == 0) return map;
  const Eigen::MatrixXd directions = symmetric_eigen(features.transpose() * features).vectors;
  const Index axes = std::min<Index>(2, features.cols());
  for (Index k = 0; k < axes; ++k) {
    Eigen::VectorXd axis = directions.col(features.cols() - 1 - k);
    Index largest = 0;
    axis.cwiseAbs().maxCoeff(&largest);
    if (axis[largest] < 0) axis = -axis;  // the same way round every time
    map.places.col(k) = features * axis;
  }
  parallel_for(count, [&](std::size_t n) {
    for (std::size_t m = 0; m < count; ++m) {
      const bool near = is_near(database.frames[n].pose, database.frames[m].pose, part.joints, degrees / kDegrees);
      if (m != n && near) ++map.neighbours[n];
    }
  });
  return map;
}

}  // namespace bodyopt
