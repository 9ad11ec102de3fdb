// Triangles that close the holes of a surface.
#pragma once

#include "geometry/mesh.h"

namespace bodyopt {

// One set of triangles for every loop of edges of one triangle alone, of the smallest area (Barequet and Sharir 1995),
// wound as the surface around it; no new vertices. The surface must be wound alike. Loops of more than 200 edges, and
// those that no triangles close without using an edge a third time, are left open. H x 3.
[[nodiscard]] Triangles fill_holes(const Positions& vertices, const Triangles& triangles);

}  // namespace bodyopt
