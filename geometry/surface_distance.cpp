#include "geometry/surface_distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace bodyopt {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr double kShorter = 1 - 1e-12;  // what is shorter by less is not: rounding ends, too

using Point = Eigen::RowVector3d;

// To c from a source that is `at_a` and `at_b` away from the ends of the edge opposite to it, straight through the
// triangle; kFar where the straight line passes beside the edge.
double through_triangle(const Point& a, double at_a, const Point& b, double at_b, const Point& c) {
  const Point along = b - a, to_c = c - a;
  const double length = along.norm();
  if (!(length > 0)) return kFar;
  // In the plane: a at the origin, b on the x axis, c above it, the source below.
  const double c_x = to_c.dot(along) / length, c_y = along.cross(to_c).norm() / length;
  const double s_x = (at_a * at_a - at_b * at_b + length * length) / (2 * length), below = at_a * at_a - s_x * s_x;
  if (below < 0 || !(c_y > 0)) return kFar;
  const double s_y = std::sqrt(below), crossing = s_x + (c_x - s_x) * s_y / (s_y + c_y);
  if (crossing < 0 || crossing > length) return kFar;
  return std::hypot(c_x - s_x, c_y + s_y);
}

}  // namespace

SurfaceDistance::SurfaceDistance(Eigen::Index vertices, const Triangles& triangles)
    : begin_(static_cast<std::size_t>(vertices) + 1, 0), corners_(static_cast<std::size_t>(triangles.size())) {
  for (Eigen::Index k = 0; k < triangles.size(); ++k) ++begin_[triangles.data()[k] + 1];
  for (std::size_t v = 1; v < begin_.size(); ++v) begin_[v] += begin_[v - 1];
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      corners_[next[triangles(t, k)]++] = {triangles(t, (k + 1) % 3), triangles(t, (k + 2) % 3)};
    }
  }
}

std::vector<SurfacePlace> SurfaceDistance::around(const Positions& positions, const SkinPoint& from,
                                                  double reach) const {
  std::vector<double> distance(begin_.size() - 1, kFar);
  std::vector<std::uint32_t> reached;
  using Step = std::pair<double, std::uint32_t>;
  std::priority_queue<Step, std::vector<Step>, std::greater<>> front;
  const auto arrive = [&](std::uint32_t vertex, double way) {
    if (!(way <= reach) || !(way < kShorter * distance[vertex])) return;
    if (distance[vertex] == kFar) reached.push_back(vertex);
    distance[vertex] = way;
    front.push({way, vertex});
  };
  for (const std::uint32_t corner : from.vertices) {
    arrive(corner, (positions.row(corner).transpose() - from.position).norm());
  }
  while (!front.empty()) {
    const double way = front.top().first;  // no binding: clang lets no lambda take one
    const std::uint32_t v = front.top().second;
    front.pop();
    if (way > distance[v]) continue;
    const Point at = positions.row(v);
    for (std::uint32_t k = begin_[v]; k < begin_[v + 1]; ++k) {
      const auto pass = [&](std::uint32_t side, std::uint32_t to) {
        arrive(to, way + (positions.row(to) - at).norm());
        if (distance[side] == kFar) return;
        arrive(to, through_triangle(at, way, positions.row(side), distance[side], positions.row(to)));
      };
      pass(corners_[k].next, corners_[k].last);
      pass(corners_[k].last, corners_[k].next);
    }
  }
  std::sort(reached.begin(), reached.end());
  std::vector<SurfacePlace> places;
  for (const std::uint32_t v : reached) places.push_back({v, distance[v]});
  return places;
}

}  // namespace bodyopt
