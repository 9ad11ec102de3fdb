// Muscles of the trunk and the neck, laid by the landmarks of a body's own skeleton.
#pragma once

#include <string>
#include <vector>

#include "assets/character.h"
#include "assets/muscles.h"

namespace bodyopt {

struct TrunkMuscles {
  std::vector<Muscle> muscles;     // rest space; "rectus_abdominis_l", "rectus_abdominis_r" ...
  std::vector<std::string> notes;  // what could not be laid, for people
};

// Those of rigs/human/trunk_muscles.json which are no part of a muscle that `others` have already. Their points move
// with the nearest bones; their radii tell the volumes of rigs/human/muscle_volumes.json in a body of this size.
// body_fat: as for the anatomy of the same body. Throws Error(mismatch) for a body without a skeleton of a human's.
TrunkMuscles trunk_muscles(const Character& character, const std::vector<Muscle>& others, double body_fat = 0.15);

}  // namespace bodyopt
