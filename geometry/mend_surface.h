// A surface made whole: holes closed, triangles wound alike.
#pragma once

#include "geometry/mesh.h"

namespace bodyopt {

// Closes every loop of edges of one triangle alone by the triangles of the smallest area (Barequet and Sharir 1995).
// They add no vertices and wind as the surface around them, which must be wound alike. Loops of more than 200 edges,
// and those that no triangles close without using an edge a third time, are left open. H x 3.
[[nodiscard]] Triangles fill_holes(const Positions& vertices, const Triangles& triangles);

// Turns triangles until any two that alone share an edge run through it in opposite directions. Of every part that such
// edges join, it turns the fewer triangles. Returns how many were turned. One-sided parts (a Moebius strip) keep edges
// that are run through twice in one direction.
Eigen::Index wind_alike(Triangles& triangles);

// Passes when every edge joins exactly two triangles that run through it in opposite directions and every vertex
// belongs to a triangle. Otherwise throws Error(mismatch) naming and counting the defect.
void require_closed(const Positions& vertices, const Triangles& triangles);

// Volume enclosed by a closed skin, cubic metres; negative when its triangles wind inwards.
[[nodiscard]] double enclosed_volume(const Positions& vertices, const Triangles& triangles);

// The mean length of the edges of all triangles, metres; 0 without triangles.
double mean_edge(const Positions& vertices, const Triangles& triangles);

// Moves vertices around self-intersections inwards and smooths them, in small steps and ever wider, until there are
// none. It then takes `room` steps more, so that tets fit between; all other vertices stay. Returns whether it came so
// far; if not, `vertices` are as they were. triangles: closed, wound outwards. The result depends on the arguments
// alone.
[[nodiscard]] bool untangle(const Triangles& triangles, int room, Positions& vertices);

// Moves all vertices by their `steps`. Steps that, taken once or twice as long, would make the surface pass through
// itself are shortened, down to none, so that tets fit between. Intersections from before may remain. The result
// depends on the arguments alone.
void step_apart(const Triangles& triangles, Positions steps, Positions& vertices);

}  // namespace bodyopt
