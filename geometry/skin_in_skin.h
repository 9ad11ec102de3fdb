// Skin that has come to lie within the body: where it folds, or is pressed into other skin.
#pragma once

#include <vector>

#include "geometry/nearest_skin.h"

namespace bodyopt {

struct BuriedVertex {
  std::uint32_t vertex;
  double depth;    // metres, to the nearest skin around it that is in the body, too, and that it lies behind
  SkinPoint skin;  // there
};

// The vertices outside of which, by a micron, the body goes on: the winding number there is 1 or more.
// They are looked for from where the `searched` triangles, some of all, pass through each other. Ascending. The skin
// winds outwards; where it is open, what lies behind an opening may be missed.
std::vector<BuriedVertex> skin_in_skin(const Positions& vertices, const Triangles& triangles,
                                       const Triangles& searched);

}  // namespace bodyopt
