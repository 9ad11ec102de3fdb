// The built-in character: a human right arm on a torso stub, and its motions. Read from the files of rigs/arm, which
// are in the program.
#pragma once

#include <vector>

#include "assets/characters/character.h"
#include "assets/characters/muscles.h"
#include "assets/clips/clip.h"
#include "trainer/motion/joint_limits.h"

namespace bodyopt::trainer {

struct BuiltinArm {
  Character character;
  std::vector<Muscle> muscles;
};

BuiltinArm build_arm();
// The same skeleton in thicker flesh, of other, fewer triangles: what the arm is carried to.
Character build_stocky_arm();

// Anatomical angles: 0 is the arm straight down, elbow straight, hand neither pronated nor bent, fingers straight. The
// torso has none. Of the arm's skeleton, as the motions are: throws Error(mismatch) when it is another one.
JointLimits arm_limits(const Skeleton& skeleton);

// Held-out motion: smooth acting (reach, curl, throw, twist), 24 frames a second; all of it in 1 to kArmHeldoutFrames
// frames, else throws Error(usage).
inline constexpr int kArmHeldoutFrames = 144;
Clip arm_heldout(const Skeleton& skeleton, int frame_count);

// The arm is held, swung up within half a second while the torso sinks, both stopped dead, and held again: 24 frames a
// second. Its pose is that of kStopBegins in every frame before, that of kStopEnds in every frame after.
inline constexpr int kStopBegins = 6, kStopEnds = 18;
Clip arm_stop(const Skeleton& skeleton);

}  // namespace bodyopt::trainer
