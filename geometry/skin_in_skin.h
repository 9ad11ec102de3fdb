// Skin that has come to lie within the body: where it folds, or is pressed into other skin.
#pragma once

#include <vector>

#include "geometry/mesh.h"

namespace bodyopt {

struct BuriedVertex {
  std::uint32_t vertex;
  double depth;  // metres, to the nearest skin there that faces it
};

// The vertices outside of which, by a micron, the body goes on: the winding number there is 1 or more. Ascending. They
// are looked for from where triangles pass through each other. The skin winds outwards; where it is open, what lies
// behind an opening may be missed.
[[nodiscard]] std::vector<BuriedVertex> skin_in_skin(const Positions& vertices, const Triangles& triangles);

}  // namespace bodyopt
