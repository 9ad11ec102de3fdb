// Surfaces that pass through themselves, moved apart.
#pragma once

#include "geometry/mesh.h"

namespace bodyopt {

// Moves the vertices around self-intersections inwards, and smooths them, in small steps and wider and wider around
// until there are none, then `room` steps more, so that tets fit between what has come apart; all other vertices stay.
// Returns whether it came so far; if not, `vertices` are as they were. triangles: closed, wound outwards. A function of
// its arguments alone.
[[nodiscard]] bool untangle(const Triangles& triangles, int room, Positions& vertices);

// Moves all vertices by their `steps`, but by shorter ones, down to none, where the surface would come to pass through
// itself by them or by steps twice as long, so that tets fit between. Where it does before, it may after. A function of
// its arguments alone.
void step_apart(const Triangles& triangles, Positions steps, Positions& vertices);

}  // namespace bodyopt
