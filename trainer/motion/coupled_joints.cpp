#include "trainer/motion/coupled_joints.h"

#include <Eigen/Cholesky>
#include <numbers>

#include "assets/wording.h"
#include "geometry/nearest_rotation.h"

namespace bodyopt {
namespace {

constexpr double kCoupled = 0.97;
constexpr double kLeastCoupledTurn = 3 * std::numbers::pi / 180;
constexpr double kRidge = 1e-4;  // square radians: turns about an axis that is not used tell nothing

using Turns = Eigen::MatrixX3d;  // N x 3: axis times twice the sine of half the angle

Turns turns_of(const Skeleton& skeleton, const std::vector<Pose>& poses, std::size_t joint) {
  Turns turns(static_cast<Eigen::Index>(poses.size()), 3);
  const Quat bind = conjugate(skeleton.joints[joint].bind.rotation);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Quat q = bind * poses[k].joints[joint].rotation;
    const double sign = q[3] < 0 ? -2 : 2;
    turns.row(static_cast<Eigen::Index>(k)) << sign * q[0], sign * q[1], sign * q[2];
  }
  return turns;
}

Eigen::Matrix3d covariance(const Turns& a, const Turns& b) {
  return (a.rowwise() - a.colwise().mean()).transpose() * (b.rowwise() - b.colwise().mean()) /
         static_cast<double>(a.rows());
}

// Of the inverse of the covariance's Cholesky factor.
Eigen::Matrix3d whitening(const Turns& turns) {
  const Eigen::Matrix3d ridged = covariance(turns, turns) + kRidge * Eigen::Matrix3d::Identity();
  return ridged.llt().matrixL().solve(Eigen::Matrix3d::Identity());
}

double canonical_correlation(const Turns& a, const Turns& b) {
  const Eigen::Matrix3d between = whitening(a) * covariance(a, b) * whitening(b).transpose();
  return nearest_rotation(between).stretches[0];
}

}  // namespace

std::vector<CoupledJoints> coupled_joints(const Skeleton& skeleton, const std::vector<Pose>& poses) {
  std::vector<CoupledJoints> coupled;
  if (poses.empty()) return coupled;
  const auto turns_enough = [&](const Turns& turns) {
    return turns.squaredNorm() > kLeastCoupledTurn * kLeastCoupledTurn * static_cast<double>(poses.size());
  };
  for (std::uint32_t j = 0; j < skeleton.size(); ++j) {
    const int above = skeleton.joints[j].parent;
    if (above < 0 || skeleton.joints[static_cast<std::size_t>(above)].parent < 0) continue;
    const auto parent = static_cast<std::uint32_t>(above);
    const Turns own = turns_of(skeleton, poses, j), others = turns_of(skeleton, poses, parent);
    if (!turns_enough(own) || !turns_enough(others)) continue;
    const double correlation = canonical_correlation(own, others);
    if (correlation > kCoupled) coupled.push_back({j, parent, correlation});
  }
  return coupled;
}

std::string describe(const std::vector<CoupledJoints>& coupled, const Skeleton& skeleton) {
  if (coupled.empty()) return "";
  std::vector<std::string> pairs;
  for (const CoupledJoints& pair : coupled) {
    pairs.push_back(skeleton.joints[pair.joint].name + "' with '" + skeleton.joints[pair.parent].name);
  }
  return "these joints turn only together, so that nobody can learn what each of them moves: " + list_names(pairs, 6) +
         "; poses that turn one without the other would tell ('deviations' in limits.json)";
}

}  // namespace bodyopt
