// Which vertex is which, after another program has written a mesh in an order of its own.
#pragma once

#include <vector>

#include "geometry/mesh.h"

namespace bodyopt {

// Of every vertex of `given` the vertex of `known` that it is, -1 where nothing tells. Both are one surface but for the
// order of vertices and triangles, and for where some vertices are: those that were not moved (by more than
// `tolerance`, metres) are known by their places, the others by the triangles between them, from neighbour to
// neighbour. Positions: V x 3, triangles: T x 3, of either.
std::vector<int> match_vertices(const Positions& known, const Triangles& known_triangles, const Positions& given,
                                const Triangles& given_triangles, double tolerance);

}  // namespace bodyopt
