// Joints: which hold which part of the skin, by the omegas of Direct Delta Mush, and the bones between them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "runtime/basis/basis.h"
#include "runtime/basis/skeleton.h"

namespace bodyopt::trainer {

// V: how much of each vertex those joints hold that are chosen (one flag for each joint), 0 to 1.
Eigen::VectorXd held_by(const Basis& basis, const std::vector<char>& chosen);

// The share of the skin that each joint holds; they sum to 1. `weights`: V, >= 0, how much each vertex counts; all
// alike where all are 0.
std::vector<double> joint_shares_of(const Basis& basis, Eigen::VectorXd weights);

// The bone (rest space, metres) from a joint to the mean of its children. The last of a chain continues its parent's
// bone; a joint on its own has a zero one.
Vec3 bone_of(const Skeleton& skeleton, std::uint32_t joint);

// The place of a character's trunk, found by its joints' names.
struct Torso {
  Eigen::Vector3d hips, up, left, front;  // rest space; unit, the character's own left
  double length = 0;                      // from the hips' joint to the neck's, metres
  std::array<int, 2> clavicles{-1, -1};   // joints, left and right; -1: none
  Eigen::VectorXd share;                  // V: how much of a vertex the trunk's joints hold, 0 to 1

  // 0 at the hips' joint, 1 at the neck's.
  double height(const Eigen::Vector3d& point) const { return (point - hips).dot(up) / length; }
};

// `place` begins the message of Error(mismatch) where hips, neck and both upper arms are not known by name.
Torso find_torso(const Basis& basis, const std::string& place);

}  // namespace bodyopt::trainer
