#include "tests/support/sound_skin.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace bodyopt::testing {

long euler_characteristic(const Triangles& triangles, std::size_t vertices) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) edges.insert(std::minmax(triangles(t, k), triangles(t, (k + 1) % 3)));
  }
  return static_cast<long>(vertices) - static_cast<long>(edges.size()) + static_cast<long>(triangles.rows());
}

std::string manifold_defect(const Triangles& triangles, std::size_t vertices) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> directed;
  std::vector<std::map<std::uint32_t, std::uint32_t>> next(vertices);  // around each vertex, neighbour by neighbour
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles(t, k), b = triangles(t, (k + 1) % 3), c = triangles(t, (k + 2) % 3);
      if (a == b || a >= vertices) return "triangle " + std::to_string(t) + " is none";
      if (++directed[{a, b}] > 1) return "an edge is used twice in one direction";
      next[a][b] = c;
    }
  }
  for (const auto& [edge, count] : directed) {
    if (!directed.contains({edge.second, edge.first})) return "an edge is open";
  }
  for (std::size_t v = 0; v < vertices; ++v) {
    if (next[v].size() < 3) return "vertex " + std::to_string(v) + " has fewer than three triangles";
    std::size_t steps = 0;
    std::uint32_t at = next[v].begin()->first;
    do {
      at = next[v].at(at);
      ++steps;
    } while (at != next[v].begin()->first && steps <= next[v].size());
    if (steps != next[v].size()) return "the triangles of vertex " + std::to_string(v) + " are not one fan";
  }
  return "";
}

}  // namespace bodyopt::testing
