#include "geometry/bad_edges.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>

namespace bodyopt {

BadEdges find_bad_edges(const Triangles& triangles) {
  struct Use {
    int forward = 0, backward = 0;
  };
  std::map<VertexPair, Use> edges;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles(t, k), b = triangles(t, (k + 1) % 3);
      Use& use = edges[std::minmax(a, b)];
      (a < b ? use.forward : use.backward)++;
    }
  }
  BadEdges bad;
  for (const auto& [edge, use] : edges) {
    const int count = use.forward + use.backward;
    if (count == 1) bad.open.push_back(edge);
    if (count > 2) bad.shared.push_back(edge);
    if (count == 2 && use.forward != use.backward) bad.flipped.push_back(edge);
  }
  return bad;
}

Triangles each_once(const Triangles& triangles) {
  std::set<std::array<std::uint32_t, 3>> known;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    std::array<std::uint32_t, 3> corners = {triangles(t, 0), triangles(t, 1), triangles(t, 2)};
    std::ranges::sort(corners);
    if (known.insert(corners).second) kept.push_back(t);
  }
  return triangles(kept, Eigen::all);
}

}  // namespace bodyopt
