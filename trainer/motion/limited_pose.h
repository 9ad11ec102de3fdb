// Poses made of the angles of a character's degrees of freedom.
#pragma once

#include <vector>

#include "trainer/motion/joint_limits.h"

namespace bodyopt {

using Angles = std::vector<double>;    // one per degree of freedom, degrees
using Deviations = std::vector<Vec3>;  // one per joint, axis times degrees; empty: none

// All that makes a pose.
struct Posture {
  Angles angles;
  Deviations deviations{};
  bool operator==(const Posture&) const = default;
};

Angles rest_angles(const JointLimits& limits);

// Rotations away from the bind pose, one per joint, about the world's axes with all parents at rest.
std::vector<Quat> joint_turns(std::size_t joint_count, const JointLimits& limits, const Posture& posture);

// The bind pose, turned. Joints without limits and deviations stay as they are in the bind pose.
Pose limited_pose(const Skeleton& skeleton, const JointLimits& limits, const Posture& posture);

// The rotation's angle, degrees, 0 to 180.
double angle_of(const Quat& rotation);

// The largest change of any angle, degrees.
double largest_change(const Angles& from, const Angles& to);

// That of any angle or of any joint's deviation.
double largest_change(const Posture& from, const Posture& to);

// Number of steps of at most `step` degrees.
std::size_t steps_between(const Angles& from, const Angles& to, double step);

// Appends evenly spaced angles after `from` up to `to` itself; nothing when they are the same.
void walk(const Angles& from, const Angles& to, double step, std::vector<Angles>& frames);

}  // namespace bodyopt
