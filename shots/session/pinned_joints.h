// Limbs that reach for where their ends are pinned: hands and feet that stay while the body moves.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "shots/session/joint_ranges.h"

namespace bodyopt {

// Turns of a limb's two bones, world: the lower one about the middle joint first, then both about the upper one.
struct LimbTurns {
  Quat lower, upper;
};

// Two-bone inverse kinematics: the middle joint bends in the plane that the limb lies in until its end is as far away
// as the target (law of cosines), then the limb swings there the shortest way. A target out of reach is pointed at, the
// limb straight. `hinge`: unit, world, that a straight limb bends about. Metres, world.
LimbTurns reach(const Vec3& upper, const Vec3& middle, const Vec3& end, const Vec3& target, const Vec3& hinge);

// The pose with pinned joints where they are pinned (metres, world), as far as the ranges of the two joints above let
// them; they keep their orientation in the world. `ranges`: of every joint, or empty. A joint that has no two above it,
// or is not there, is left alone.
Pose pinned(const Skeleton& skeleton, const std::vector<std::optional<JointRange>>& ranges, Pose pose,
            const std::map<std::string, Vec3>& pins);

// A pin that its limb does not reach.
struct MissedPin {
  std::string joint;
  double away;     // metres
  bool by_limits;  // without the ranges it would be nearer
};

// Those that are missed by more than a millimetre where pinned() is done to a pose.
std::vector<MissedPin> missed_pins(const Skeleton& skeleton, const std::vector<std::optional<JointRange>>& ranges,
                                   const Pose& pose, const std::map<std::string, Vec3>& pins);

// Has the joint two above it, that can reach for it?
bool ends_a_limb(const Skeleton& skeleton, const std::string& joint);

}  // namespace bodyopt
