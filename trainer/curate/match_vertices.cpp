#include "trainer/curate/match_vertices.h"

#include <map>
#include <numeric>
#include <utility>

#include "geometry/point_grid.h"

namespace bodyopt {
namespace {

using Eigen::Index;
// The corner that a triangle has beside a directed edge; -1 where two triangles claim it.
using Opposite = std::map<std::pair<std::uint32_t, std::uint32_t>, int>;

Opposite opposite_corners(const Triangles& triangles) {
  Opposite corners;
  for (Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::pair edge(triangles(t, k), triangles(t, (k + 1) % 3));
      const auto [there, added] = corners.emplace(edge, static_cast<int>(triangles(t, (k + 2) % 3)));
      if (!added) there->second = -1;
    }
  }
  return corners;
}

// The only point within the tolerance, -1 where there is none or are several.
int only_point_near(const PointGrid& grid, const Positions& points, const Eigen::RowVector3d& place, double tolerance) {
  int found = -1, count = 0;
  const Eigen::RowVector3d reach = Eigen::RowVector3d::Constant(tolerance);
  grid.visit(place - reach, place + reach, [&](int n) {
    if ((points.row(n) - place).norm() > tolerance) return;
    found = n;
    ++count;
  });
  return count == 1 ? found : -1;
}

std::vector<int> by_place(const Positions& known, const Positions& given, double tolerance, std::vector<char>& taken) {
  std::vector<int> all(static_cast<std::size_t>(known.rows()));
  std::iota(all.begin(), all.end(), 0);
  const PointGrid grid(known, all, tolerance);
  std::vector<int> match(static_cast<std::size_t>(given.rows()), -1), claims(all.size(), 0);
  for (std::size_t v = 0; v < match.size(); ++v) {
    match[v] = only_point_near(grid, known, given.row(static_cast<Index>(v)), tolerance);
    if (match[v] >= 0) ++claims[static_cast<std::size_t>(match[v])];
  }
  for (int& known_vertex : match) {
    if (known_vertex >= 0 && claims[static_cast<std::size_t>(known_vertex)] > 1) known_vertex = -1;
    if (known_vertex >= 0) taken[static_cast<std::size_t>(known_vertex)] = true;
  }
  return match;
}

// The third corner of triangles of which two are known. Whether any was found.
bool grow(const Opposite& opposite, const Triangles& given, std::vector<int>& match, std::vector<char>& taken) {
  bool grown = false;
  for (Index t = 0; t < given.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      int& third = match[given(t, (k + 2) % 3)];
      const int a = match[given(t, k)], b = match[given(t, (k + 1) % 3)];
      if (third >= 0 || a < 0 || b < 0) continue;
      const auto found = opposite.find({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b)});
      if (found == opposite.end() || found->second < 0 || taken[static_cast<std::size_t>(found->second)]) continue;
      third = found->second;
      taken[static_cast<std::size_t>(third)] = true;
      grown = true;
    }
  }
  return grown;
}

}  // namespace

std::vector<int> match_vertices(const Positions& known, const Triangles& known_triangles, const Positions& given,
                                const Triangles& given_triangles, double tolerance) {
  std::vector<char> taken(static_cast<std::size_t>(known.rows()), false);
  std::vector<int> match = by_place(known, given, tolerance, taken);
  const Opposite opposite = opposite_corners(known_triangles);
  while (grow(opposite, given_triangles, match, taken)) {
  }
  return match;
}

}  // namespace bodyopt
