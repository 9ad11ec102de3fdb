// Joints that a clip holds turned beyond what the joint limits allow: most likely it rests in another pose.
#pragma once

#include <string>
#include <vector>

#include "runtime/basis/skeleton.h"
#include "trainer/motion/joint_limits.h"

namespace bodyopt::trainer {

// Poses made of the angles of a character's degrees of freedom.

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

// The largest change of any angle or of any joint's deviation.
double largest_change(const Posture& from, const Posture& to);

// Number of steps of at most `step` degrees.
std::size_t steps_between(const Angles& from, const Angles& to, double step);

// Appends evenly spaced angles after `from` up to `to` itself; nothing when they are the same.
void walk(const Angles& from, const Angles& to, double step, std::vector<Angles>& frames);

// A joint and its parent that turn together. What one of them moves cannot be learned from poses in which the other
// does not stay where it is.
struct CoupledJoints {
  std::uint32_t joint, parent;
  double correlation;  // the largest canonical one (Hotelling 1936) of their turns away from the bind pose, 0 to 1
};

// Joints coupled by more than 0.97 (of a turn of 45 degrees, 11 or less are the joint's own), in joint order. Joints
// that turn by less than 3 degrees, root mean square, and those next to a root are left out.
std::vector<CoupledJoints> coupled_joints(const Skeleton& skeleton, const std::vector<Pose>& poses);

// "these joints turn only together, ...: 'Neck1' with 'Neck', ...". Empty for none.
std::string describe(const std::vector<CoupledJoints>& coupled, const Skeleton& skeleton);

// A turn from the nearest rotation that a joint's degrees of freedom reach to the joint's own, nearly the same in
// nearly every frame.
struct HeldTurn {
  std::uint32_t joint;
  Vec3 axis;       // unit; rest space, as axes of limits are; the turn is applied before the joint's others
  double degrees;  // on average
  double share;    // of the frames, those in which the joint is beyond its limits
};

// Turns of 25 degrees and more that vary by less than half their size, in 95 % of the frames or more, in joint order.
// Joints without limits are not judged.
std::vector<HeldTurn> held_turns(const JointLimits& limits, const Skeleton& skeleton, const std::vector<Pose>& poses);

// "'LeftArm' is turned by 31 degrees about its length, beyond its limits in every frame: ..."
std::string describe(const HeldTurn& turn, const Skeleton& skeleton, std::size_t frames);

// Names of joints that some frame turns but no degree of freedom does; roots turn as they like and are left out.
std::vector<std::string> turning_without_limits(const JointLimits& limits, const Skeleton& skeleton,
                                                const std::vector<Pose>& poses);

// How every pose turns a joint away from the bind pose, about the world's axes: as joint_turns().
std::vector<Quat> turns_from_bind(const Skeleton& skeleton, const std::vector<Pose>& poses, std::size_t joint);

// The way from a joint to the middle of the joints below, in the bind pose, metres; zero where there are none.
Vec3 length_of_bone(const Skeleton& skeleton, std::size_t joint);

}  // namespace bodyopt::trainer
