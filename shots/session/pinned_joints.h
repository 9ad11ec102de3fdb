// Limbs that reach for where their ends are pinned: hands and feet that stay while the body moves.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "runtime/core/transform.h"
#include "trainer/motion/joint_limits.h"

namespace bodyopt {

// Turns of joints as sliders have them, about x, then y, then z, degrees; and how far the joints of a character may
// turn.

Quat turn_of(const Vec3& degrees);

// Of the angles that make the turn, those that are smallest in sum.
Vec3 degrees_of(const Quat& turn);

// Of a joint's turn, the one of the other side's joint that makes it the mirror
// image at the plane x = 0. `axes`, `other_axes`: rotations of the two in the bind pose, joint to world.
Vec3 mirrored_angles(const Vec3& degrees, const Quat& axes, const Quat& other_axes);

// Of a joint's turn away from the bind pose, as angles about its own axes, degrees.
struct JointRange {
  Vec3 low{}, high{};
};

// Of every joint of the skeleton: as far as one of its degrees of freedom goes, and of one that is oblique to the axes
// the part along each. Axes that none turns about are held. None: a root, or a joint without any.
std::vector<std::optional<JointRange>> joint_ranges(const JointLimits& limits, const Skeleton& skeleton);

// Local rotations. `clip` turned by `degrees`, axis by axis as far as the range lets it; an angle that the clip has
// beyond the range comes back, but goes no further.
Quat turned_within(const JointRange& range, const Quat& bind, const Quat& clip, const Vec3& degrees);

// What may be added to a clip's rotation about each axis alone; always zero, too.
JointRange turns_within(const JointRange& range, const Quat& bind, const Quat& clip);

// Turns of a limb's two bones, world: the lower one about the middle joint first, then both about the upper one.
struct LimbTurns {
  Quat lower, upper;
};

// Two-bone inverse kinematics: the middle joint bends in the plane that the limb lies in until its end is as far away
// as the target (law of cosines), then the limb swings there the shortest way. A target out of reach is pointed at, the
// limb straight. `hinge`: unit, world, that a straight limb bends about. Metres, world.
LimbTurns reach(const Vec3& upper, const Vec3& middle, const Vec3& end, const Vec3& target, const Vec3& hinge);

// Ends of limbs that are to stay, by joint.
struct Pins {
  std::map<std::string, Vec3> at;        // metres, world
  std::map<std::string, Quat> facing{};  // joint to world; those without keep their orientation in the world
};

// The pose with pinned joints where they are pinned: first those of the spine, all of which bends for them, then limbs,
// as far as the ranges of the two joints above let them. The toe at the end of a foot, a short bone at that of a limb,
// is held by the limb; where that is too short, the heel comes up. `ranges`: of every joint, or empty. A joint that has
// no two above it, or is not there, is left alone.
Pose pinned(const Skeleton& skeleton, const std::vector<std::optional<JointRange>>& ranges, Pose pose,
            const Pins& pins);

// A pin that its limb does not reach.
struct MissedPin {
  std::string joint;
  double away;     // metres
  bool by_limits;  // without the ranges it would be nearer
};

// Those that are missed by more than a millimetre where pinned() is done to a pose.
std::vector<MissedPin> missed_pins(const Skeleton& skeleton, const std::vector<std::optional<JointRange>>& ranges,
                                   const Pose& pose, const Pins& pins);

// Is it at the end of a short bone, the toe of a foot, which ends a limb of long ones?
bool ends_a_foot(const Skeleton& skeleton, std::size_t joint);

// Is it a chest, a neck or a head, whose pin bends all of the spine below it?
bool is_on_spine(const Skeleton& skeleton, std::size_t joint);

// Has the joint two above it, that can reach for it?
bool ends_a_limb(const Skeleton& skeleton, const std::string& joint);

}  // namespace bodyopt
