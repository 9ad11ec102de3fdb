// A skin bound to moving joints, and the blend shapes that make linear blend skinning give any other.
#pragma once

#include <span>
#include <vector>

#include "assets/characters/character.h"
#include "assets/clips/clip.h"

namespace bodyopt {

struct BoundSkin {
  Character character;  // with its weights
  Clip clip;            // of its joints; of every frame, the first and the last among them
};

// Returns offsets from the rest shape, O x 3, rest space, metres. Linear blend skinning in the frame's pose takes the
// rest shape with them to `shape`, O x 3, world. Where blended joints flatten a vertex (a turn by 180 degrees), a short
// offset comes near. It is by Tikhonov's least squares, iterated once (King and Chillingworth 1979).
std::vector<float> blend_shape(const BoundSkin& skin, int frame, std::span<const float> shape);

}  // namespace bodyopt
