// Where the trunk of a character is, told from its joints' names.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>

#include "geometry/mesh.h"
#include "runtime/basis/basis.h"

namespace bodyopt {

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

}  // namespace bodyopt
