// The rings and arrows by which a joint is turned and moved with the mouse.
#pragma once

#include <vector>

#include "runtime/core/transform.h"

namespace bodyopt::viewport {

class Scene;
struct Controls;

// A ring turns a joint by one of its three angles (pinned_joints.h). Metres, world; degrees.
struct TurnRing {
  std::size_t axis;    // x, y, z
  Vec3 centre, along;  // along: of the axis, unit; seen against it, angles grow to the left
  Vec3 zero;           // unit, across: where 0 is
  double radius;
  double low, high, angle;  // that may be added to the clip, and is

  Vec3 point(double degrees) const;
};

// Returns the lead's rings at the frame; none where no joint is selected, or the tool in hand moves it. Where limits
// hold an angle, there is no room between low and high.
std::vector<TurnRing> turn_rings(const Scene& scene, const Controls& controls);

// An arrow along an axis of the world, metres.
struct MoveArrow {
  std::size_t axis;  // x, y, z
  Vec3 from, to;
};

// Returns the lead's arrows at the frame; none where the selected joint may not move, or the tool turns.
std::vector<MoveArrow> move_arrows(const Scene& scene, const Controls& controls);

}  // namespace bodyopt::viewport
