// Poses made of the angles of a character's degrees of freedom.
#pragma once

#include <vector>

#include "trainer/motion/joint_limits.h"

namespace bodyopt {

using Angles = std::vector<double>;  // one per degree of freedom, degrees

Angles rest_angles(const JointLimits& limits);

// Rotations away from the bind pose, one per joint, about the world's axes with all parents at rest.
std::vector<Quat> joint_turns(std::size_t joint_count, const JointLimits& limits, const Angles& angles);

// The bind pose, turned. Joints without limits stay as they are in the bind pose.
Pose limited_pose(const Skeleton& skeleton, const JointLimits& limits, const Angles& angles);

// The rotation's angle, degrees, 0 to 180.
double angle_of(const Quat& rotation);

}  // namespace bodyopt
