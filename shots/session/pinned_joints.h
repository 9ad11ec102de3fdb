// Limbs that reach for where their ends are pinned: hands and feet that stay while the body moves.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "runtime/core/transform.h"
#include "trainer/motion/joint_limits.h"

namespace bodyopt::shots {

// Turns of joints as sliders have them, about x, then y, then z, degrees; and how far the joints of a character may
// turn.

Quat turn_of(const Vec3& degrees);

// Returns the angles that make the turn and are smallest in sum.
Vec3 degrees_of(const Quat& turn);

// Mirrors a joint's turn at the plane x = 0, as a turn of the other side's joint. `axes`, `other_axes`: rotations of
// the two in the bind pose, joint to world.
Vec3 mirrored_angles(const Vec3& degrees, const Quat& axes, const Quat& other_axes);

// The range of a joint's turn away from the bind pose, as angles about its own axes, degrees.
struct JointRange {
  Vec3 low{}, high{};
};

// Returns how far the degrees of freedom turn every joint; one that is oblique to the axes counts with its part along
// each. Axes that none turns about are held. None: a root, or a joint without any.
std::vector<std::optional<JointRange>> joint_ranges(const trainer::JointLimits& limits, const Skeleton& skeleton);

// Takes and gives local rotations: `clip` turned by `degrees`, axis by axis as far as the range lets it. An angle that
// the clip has beyond the range comes back, but goes no further.
Quat turned_within(const JointRange& range, const Quat& bind, const Quat& clip, const Vec3& degrees);

// Returns what may be added to a clip's rotation about each axis alone; zero always may.
JointRange turns_within(const JointRange& range, const Quat& bind, const Quat& clip);

// Turns of a limb's two bones, world: the lower one about the middle joint first, then both about the upper one.
struct LimbTurns {
  Quat lower, upper;
};

// Two-bone inverse kinematics: the middle joint bends in the limb's plane until its end is as far away as the target
// (law of cosines). Then the limb swings there the shortest way. A target out of reach is pointed at, the limb
// straight. `hinge`: unit, world, the axis about which a straight limb bends. Metres, world.
LimbTurns reach(const Vec3& upper, const Vec3& middle, const Vec3& end, const Vec3& target, const Vec3& hinge);

// Ends of limbs that are to stay, by joint.
struct Pins {
  std::map<std::string, Vec3> at;        // metres, world
  std::map<std::string, Quat> facing{};  // joint to world; those without keep their orientation in the world
};

// Brings pinned joints to their pins: first those of the spine, all of which bends for them, then limbs. Ranges limit
// the turns. The limb also holds the toe of a foot, a short bone at its end; where it is too short, the heel comes up.
// So it does over a pinned foot whose ankle ends: the toe stays.
// `ranges`: of every joint, or empty. A joint that has no two above it, or is not there, is left alone.
Pose pinned(const Skeleton& skeleton, const std::vector<std::optional<JointRange>>& ranges, Pose pose,
            const Pins& pins);

// A pin that its limb does not reach.
struct MissedPin {
  std::string joint;
  double away;           // metres
  bool by_limits{};      // without the ranges it would be nearer
  bool on_toes = false;  // its toe is where the pin wants it: only the heel is up
  double tipped = 0;     // degrees: a foot without a toe, away from how it was pinned
};

// "LeftFoot: 190 mm from its pin, held by joint limits"
std::string describe(const MissedPin& pin);

// Returns the pins that are more than a millimetre away after pinned().
std::vector<MissedPin> missed_pins(const Skeleton& skeleton, const std::vector<std::optional<JointRange>>& ranges,
                                   const Pose& pose, const Pins& pins);

// Is it at the end of a short bone, the toe of a foot, which ends a limb of long ones?
bool ends_a_foot(const Skeleton& skeleton, std::size_t joint);

// Is it a chest, a neck or a head, whose pin bends all of the spine below it?
bool is_on_spine(const Skeleton& skeleton, std::size_t joint);

// Has the joint two above it, that can reach for it?
bool ends_a_limb(const Skeleton& skeleton, const std::string& joint);

}  // namespace bodyopt::shots
