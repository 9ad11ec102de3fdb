// A skin bound to moving joints, and the blend shapes that make linear blend skinning give any other.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "assets/character.h"
#include "assets/clip.h"
#include "runtime/core/json.h"

namespace bodyopt {

class GlbWriter;

struct BoundSkin {
  Character character;  // with its weights
  Clip clip;            // of its joints; of every frame, the first and the last among them
};

// O x 3, rest space, metres: added to the rest shape it is what linear blend skinning in the pose of the frame takes to
// `shape` (O x 3, world). Where blended joints flatten a vertex (a turn by 180 degrees) it is the short offset that
// comes near: Tikhonov's least squares, iterated once (King and Chillingworth 1979).
std::vector<float> blend_shape(const BoundSkin& skin, int frame, std::span<const float> shape);

// The vertices of a glTF mesh, of each the output vertex that it is: POSITION and NORMAL at rest, JOINTS_n, WEIGHTS_n.
Json bound_vertices(const Character& character, std::span<const std::uint32_t> places, GlbWriter& glb);

}  // namespace bodyopt
