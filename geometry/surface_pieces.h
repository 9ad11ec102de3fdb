// The pieces that a surface is in.
#pragma once

#include <vector>

#include "geometry/mesh.h"

namespace bodyopt {

struct SurfacePieces {
  std::vector<int> of_vertex;  // V: numbered by first vertex; a vertex of no triangle is a piece of its own
  int count = 0;
};

// Vertices joined by triangles, directly or through others, are one piece.
SurfacePieces surface_pieces(Eigen::Index vertices, const Triangles& triangles);

}  // namespace bodyopt
