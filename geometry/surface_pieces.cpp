#include "geometry/surface_pieces.h"

#include <algorithm>
#include <numeric>

namespace bodyopt {

SurfacePieces surface_pieces(Eigen::Index vertices, const Triangles& triangles) {
  std::vector<std::uint32_t> root(static_cast<std::size_t>(vertices));
  std::iota(root.begin(), root.end(), 0u);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 1; k < 3; ++k) {
      const std::uint32_t a = find(triangles(t, 0)), b = find(triangles(t, k));
      root[std::max(a, b)] = std::min(a, b);
    }
  }
  SurfacePieces pieces;
  for (std::uint32_t v = 0; v < root.size(); ++v) {
    const std::uint32_t first = find(v);  // the lowest of its piece
    pieces.of_vertex.push_back(first == v ? pieces.count++ : pieces.of_vertex[first]);
  }
  return pieces;
}

}  // namespace bodyopt
