// A surface made whole: holes closed, triangles wound alike.
#pragma once

#include "geometry/mesh.h"

namespace bodyopt {

// One set of triangles for every loop of edges of one triangle alone, of the smallest area (Barequet and Sharir 1995),
// wound as the surface around it; no new vertices. The surface must be wound alike. Loops of more than 200 edges, and
// those that no triangles close without using an edge a third time, are left open. H x 3.
[[nodiscard]] Triangles fill_holes(const Positions& vertices, const Triangles& triangles);

// Turns triangles until any two that alone share an edge run through it in opposite directions, of every part of the
// surface that such edges join the fewer. Returns how many were turned. What is one-sided (a Moebius strip) keeps edges
// that are run through twice in one direction.
Eigen::Index wind_alike(Triangles& triangles);

// Passes when every edge joins exactly two triangles that run through it in opposite directions and every vertex
// belongs to a triangle. Otherwise throws Error(mismatch) naming and counting the defect.
void require_closed(const Positions& vertices, const Triangles& triangles);

// Volume enclosed by a closed skin, cubic metres; negative when its triangles wind inwards.
[[nodiscard]] double enclosed_volume(const Positions& vertices, const Triangles& triangles);

// Of the edges of all triangles, metres; 0 without triangles.
double mean_edge(const Positions& vertices, const Triangles& triangles);

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
