#include "geometry/surface_pieces.h"

#include "base/disjoint_sets.h"

namespace bodyopt {

SurfacePieces surface_pieces(Eigen::Index vertices, const Triangles& triangles) {
  const auto count = static_cast<std::size_t>(vertices);
  DisjointSets sets(count);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 1; k < 3; ++k) sets.join(triangles(t, 0), triangles(t, k));
  }
  SurfacePieces pieces;
  for (std::size_t v = 0; v < count; ++v) {
    const std::size_t first = sets.lowest(v);
    pieces.of_vertex.push_back(first == v ? pieces.count++ : pieces.of_vertex[first]);
  }
  return pieces;
}

}  // namespace bodyopt
