// What was done to the shapes of a take as a whole, so that they do not lie where its frames are.
#pragma once

#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace bodyopt {

struct Character;
struct Clip;

struct Misplacement {
  std::string
      cause;        // "the frames are numbered 1 too high", with its number; empty: none explains most of the distance
  double left = 1;  // share of the distance from the skinned character that is left without it
};

// The simplest of these that explains more of the distance between shapes and the skinned character than it leaves:
// frames early or late, another size, turned, mirrored, moved, several of these at once, or each frame moved (and
// turned) for itself, as where the root's travel is missing. What bulges, folds and swings is none of them.
//
// `shapes`: V x 3 welded, metres, world, of some frames of the clip, `frames`; one or more.
Misplacement find_misplacement(const Character& character, const Clip& clip, const std::vector<int>& frames,
                               const std::vector<Positions>& shapes);

}  // namespace bodyopt
