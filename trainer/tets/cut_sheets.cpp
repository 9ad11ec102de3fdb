#include "trainer/tets/cut_sheets.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <utility>

#include "base/disjoint_sets.h"

namespace bodyopt {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;
using TrianglesAt = std::map<Edge, std::vector<Eigen::Index>>;

TrianglesAt triangles_at_edges(const Triangles& triangles, const std::vector<bool>& is_cut) {
  TrianglesAt at;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    if (is_cut[static_cast<std::size_t>(t)]) continue;
    for (int k = 0; k < 3; ++k) at[std::minmax(triangles(t, k), triangles(t, (k + 1) % 3))].push_back(t);
  }
  return at;
}

bool is_manifold(const TrianglesAt& at) {
  return std::all_of(at.begin(), at.end(), [](const auto& edge) { return edge.second.size() <= 2; });
}

// The patch of every triangle: those that edges of two triangles join. It has the number of its first triangle.
std::vector<std::size_t> patches_of(const TrianglesAt& at, std::size_t triangles) {
  DisjointSets sets(triangles);
  for (const auto& [edge, around] : at) {
    if (around.size() == 2) sets.join(static_cast<std::size_t>(around[0]), static_cast<std::size_t>(around[1]));
  }
  std::vector<std::size_t> patch;
  for (std::size_t t = 0; t < triangles; ++t) patch.push_back(sets.lowest(t));
  return patch;
}

double area_of_triangle(const Positions& vertices, const Triangles& triangles, Eigen::Index t) {
  const Eigen::Vector3d a = vertices.row(triangles(t, 0)), b = vertices.row(triangles(t, 1)),
                        c = vertices.row(triangles(t, 2));
  return (b - a).cross(c - a).norm() / 2;
}

// The smallest patch with open edges that meets others; the number of triangles where there is none.
std::size_t smallest_sheet(const Positions& vertices, const Triangles& triangles, const TrianglesAt& at,
                           const std::vector<std::size_t>& patch) {
  std::vector<bool> is_open(patch.size(), false), meets_others(patch.size(), false);
  for (const auto& [edge, around] : at) {
    for (const Eigen::Index t : around) {
      const std::size_t of = patch[static_cast<std::size_t>(t)];
      if (around.size() == 1) is_open[of] = true;
      if (around.size() > 2) meets_others[of] = true;
    }
  }
  std::vector<double> area(patch.size(), 0);
  for (std::size_t t = 0; t < patch.size(); ++t) {
    area[patch[t]] += area_of_triangle(vertices, triangles, static_cast<Eigen::Index>(t));
  }
  std::size_t best = patch.size();
  for (std::size_t p = 0; p < patch.size(); ++p) {
    if (is_open[p] && meets_others[p] && (best == patch.size() || area[p] < area[best])) best = p;
  }
  return best;
}

}  // namespace

std::vector<bool> sheet_triangles(const Positions& vertices, const Triangles& triangles) {
  std::vector<bool> is_cut(static_cast<std::size_t>(triangles.rows()), false);
  for (;;) {
    const TrianglesAt at = triangles_at_edges(triangles, is_cut);
    if (is_manifold(at)) return is_cut;
    const std::vector<std::size_t> patch = patches_of(at, is_cut.size());
    const std::size_t sheet = smallest_sheet(vertices, triangles, at, patch);
    if (sheet == patch.size()) return is_cut;
    for (std::size_t t = 0; t < patch.size(); ++t) {
      if (patch[t] == sheet) is_cut[t] = true;
    }
  }
}

}  // namespace bodyopt
