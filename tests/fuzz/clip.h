// What is looked at in clips that are accepted.
#pragma once

#include "assets/clips/clip.h"
#include "tests/fuzz/fuzz_target.h"

namespace bodyopt::fuzz {

inline void require_finite_poses(const Clip& clip) {
  for (const Pose& pose : clip.poses) {
    for (const JointTransform& joint : pose.joints) {
      require_finite(joint.translation, "translations");
      require_finite(joint.rotation, "rotations");
      require_finite(joint.scale, "scales");
    }
    require_finite(pose.controls, "controls");
  }
}

}  // namespace bodyopt::fuzz
