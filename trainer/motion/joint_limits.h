// limits.json: the degrees of freedom of a character's joints and how far each may go.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runtime/basis/skeleton.h"

namespace bodyopt {

// What one degree of freedom does to one joint: a turn by share x (angle - rest) about the axis.
struct JointTurn {
  std::uint32_t joint;
  Vec3 axis;         // unit; rest space: the world's axes in the bind pose
  double share = 1;  // of the angle away from rest
};

// Angles are in degrees, as anatomy tables have them.
struct DegreeOfFreedom {
  std::string name;
  double rest, min, max;  // `rest`: what the bind pose counts as
  std::vector<JointTurn> turns;
};

// A joint's rotation away from the bind pose is the product of its turns in the order of the list: the last is applied
// first.
struct JointLimits {
  std::vector<DegreeOfFreedom> dofs;
};

// A mirrored degree of freedom follows the one it is the mirror image of. Throws Error(file) for bad bytes, and
// Error(mismatch) for joints the skeleton lacks and for limits that exclude the rest pose.
JointLimits read_joint_limits(const std::filesystem::path& path, const Skeleton& skeleton);
void write_joint_limits(const JointLimits& limits, const Skeleton& skeleton, const std::filesystem::path& path);

}  // namespace bodyopt
