// The limb of the simulation's tests as files, for the program.
#pragma once

#include <string>

#include "tests/simulate/limb.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {

// A limb of 0.5 m in a unit that is `per_metre` to a metre, and a clip that bends it.
struct LimbFiles {
  LimbFiles(const TemporaryFolder& folder, double per_metre) {
    Character limb = make_limb();
    limb.vertices *= per_metre;
    for (Joint& joint : limb.skeleton.joints) {
      joint.bind.translation = per_metre * joint.bind.translation;
      joint.default_local = joint.bind;
      for (auto& row : joint.inverse_bind.m) row[3] *= per_metre;
    }
    Clip clip;
    clip.name = "bend";
    for (int k = 0; k < 6; ++k) clip.poses.push_back(bent(limb, degrees(10.0 * k)));
    character = (folder / "limb.glb").string();
    motion = (folder / "bend.glb").string();
    write_character(limb, character);
    write_clip(clip, limb.skeleton, motion);
  }
  std::string character, motion;
};

}  // namespace bodyopt
