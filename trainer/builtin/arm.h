// The built-in character: a human right arm on a torso stub, made in code, and its motions.
#pragma once

#include <vector>

#include "assets/character.h"
#include "assets/clip.h"
#include "assets/muscles.h"

namespace bodyopt {

struct BuiltinArm {
  Character character;
  std::vector<Muscle> muscles;
};

// Deterministic: the same character every time.
BuiltinArm build_arm();
// The same skeleton in thicker flesh, of other, fewer triangles: what the arm is carried to.
BuiltinArm build_stocky_arm();

// Held-out motion: smooth acting (reach, curl, throw, twist), 24 frames a second.
Clip arm_heldout(const Skeleton& skeleton, int frame_count);

// The arm is held, swung up within half a second while the torso sinks, both stopped dead, and held again: 24 frames a
// second. Its pose is that
// of kStopBegins in every frame before, that of kStopEnds in every frame after.
inline constexpr int kStopBegins = 6, kStopEnds = 18;
Clip arm_stop(const Skeleton& skeleton);

}  // namespace bodyopt
