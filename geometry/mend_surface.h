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

}  // namespace bodyopt
