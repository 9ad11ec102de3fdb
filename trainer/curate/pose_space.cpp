#include "trainer/curate/pose_space.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "assets/characters/joints_with_skin.h"
#include "base/linear_algebra.h"
#include "base/parallel.h"
#include "base/wording.h"
#include "runtime/core/error.h"
#include "runtime/host/rig.h"

namespace bodyopt::trainer {
namespace {

constexpr double kLeastShare = 0.05;

Eigen::Vector3d rotation_vector(const Quat& from, const Quat& to) {
  Quat q = conjugate(normalized(from)) * normalized(to);
  if (q[3] < 0) q = {-q[0], -q[1], -q[2], -q[3]};
  const Eigen::Vector3d axis(q[0], q[1], q[2]);
  const double size = axis.norm();
  return size > 1e-12 ? Eigen::Vector3d(2 * std::atan2(size, q[3]) / size * axis) : Eigen::Vector3d(2 * axis);
}

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

std::vector<std::uint32_t> joints_moving(const Character& character, const Eigen::VectorXd& mask) {
  std::vector<double> share(character.skeleton.size(), 0.0);
  for (std::size_t v = 0; v < character.weights.size(); ++v) {
    for (const JointWeight& weight : character.weights[v]) {
      share[weight.joint] += weight.weight * mask[static_cast<Eigen::Index>(v)];
    }
  }
  const std::vector<std::uint32_t> all = joints_that_bend(character);
  std::vector<std::uint32_t> moving;
  std::copy_if(all.begin(), all.end(), std::back_inserter(moving),
               [&](std::uint32_t j) { return share[j] >= kLeastShare * mask.sum(); });
  return moving.empty() ? all : moving;
}

std::vector<std::uint32_t> joints_named(const Skeleton& skeleton, const std::vector<std::string>& names,
                                        const std::string& place) {
  std::vector<std::uint32_t> joints;
  for (const std::string& name : names) {
    const int joint = skeleton.find(name);
    if (joint < 0) {
      throw Error(ErrorKind::mismatch, place, ": the character has no joint '", name, "'; the nearest are ",
                  list_names(nearest_names(names_of(skeleton.joints), name)));
    }
    joints.push_back(static_cast<std::uint32_t>(joint));
  }
  return joints;
}

Eigen::VectorXd turns_between(const Pose& from, const Pose& to, const std::vector<std::uint32_t>& joints) {
  Eigen::VectorXd turns(3 * static_cast<Eigen::Index>(joints.size()));
  for (std::size_t k = 0; k < joints.size(); ++k) {
    turns.segment<3>(3 * static_cast<Eigen::Index>(k)) =
        rotation_vector(from.joints[joints[k]].rotation, to.joints[joints[k]].rotation);
  }
  return turns;
}

Eigen::VectorXd pose_difference(const Pose& from, const Pose& to, const std::vector<std::uint32_t>& joints) {
  const Eigen::VectorXd turns = turns_between(from, to, joints);
  Eigen::VectorXd difference(turns.size() + static_cast<Eigen::Index>(from.controls.size()));
  difference.head(turns.size()) = turns;
  for (std::size_t c = 0; c < from.controls.size(); ++c) {
    difference[turns.size() + static_cast<Eigen::Index>(c)] = double{to.controls[c]} - double{from.controls[c]};
  }
  return difference;
}

bool is_near(const Pose& from, const Pose& to, const std::vector<std::uint32_t>& joints, double reach) {
  double left = reach * reach;
  for (std::size_t k = 0; k < joints.size() && left > 0; ++k) {
    const Quat &a = from.joints[joints[k]].rotation, &b = to.joints[joints[k]].rotation;
    // Quaternions of rotations apart by an angle have the cosine of its half between them.
    const double cosine = std::abs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]);
    const double angle = 2 * std::acos(std::min(1.0, cosine));
    left -= angle * angle;
  }
  for (std::size_t c = 0; c < from.controls.size(); ++c) {
    left -= std::pow(double{to.controls[c]} - double{from.controls[c]}, 2);
  }
  return left > 0;
}

double pose_distance(const Pose& from, const Pose& to, const std::vector<std::uint32_t>& joints) {
  return 180 / std::numbers::pi * pose_difference(from, to, joints).norm();
}

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

}  // namespace bodyopt::trainer
