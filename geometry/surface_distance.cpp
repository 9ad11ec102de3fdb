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

constexpr int kSmoothingSteps = 4;
constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr double kShorter = 1 - 1e-12;  // what is shorter by less is not: rounding ends, too

using Point = Eigen::RowVector3d;

// The distance to c, straight through the triangle, from a source that is `at_a` and `at_b` away from a and b. It is
// kFar where the straight line passes beside the edge.
double through_triangle(const Point& a, double at_a, const Point& b, double at_b, const Point& c) {
  const Point along = b - a, to_c = c - a;
  const double length = along.norm();
  if (!(length > 0)) return kFar;
  // We compute in the plane: a at the origin, b on the x axis, c above it, the source below.
  const double c_x = to_c.dot(along) / length, c_y = along.cross(to_c).norm() / length;
  const double s_x = (at_a * at_a - at_b * at_b + length * length) / (2 * length), below = at_a * at_a - s_x * s_x;
  if (below < 0 || !(c_y > 0)) return kFar;
  const double s_y = std::sqrt(below), crossing = s_x + (c_x - s_x) * s_y / (s_y + c_y);
  if (crossing < 0 || crossing > length) return kFar;
  return std::hypot(c_x - s_x, c_y + s_y);
}

}  // namespace

Eigen::VectorXd lumped_areas(const Positions& rest, const Triangles& triangles) {
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(rest.rows());
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const auto [a, b, c] = corners_of(rest, triangles, t);
    const double third = (b - a).cross(c - a).norm() / 6;
    for (int k = 0; k < 3; ++k) areas[triangles(t, k)] += third;
  }
  const double mean = areas.size() > 0 ? areas.mean() : 0;
  return areas.cwiseMax(mean > 0 ? 1e-3 * mean : 1.0);
}

Eigen::SparseMatrix<double> cotangent_laplacian(const Positions& rest, const Triangles& triangles) {
  std::vector<Eigen::Triplet<double>> halves;  // half cotangents of directed edges, upper triangle
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int corner = static_cast<int>(triangles(t, k)), i = static_cast<int>(triangles(t, (k + 1) % 3)),
                j = static_cast<int>(triangles(t, (k + 2) % 3));
      const Eigen::RowVector3d a = rest.row(i) - rest.row(corner), b = rest.row(j) - rest.row(corner);
      const double area = a.cross(b).norm();
      if (!(area > 1e-10 * std::max(a.squaredNorm(), b.squaredNorm()))) continue;
      halves.emplace_back(std::min(i, j), std::max(i, j), 0.5 * a.dot(b) / area);
    }
  }
  const Eigen::SparseMatrix<double> edges = sparse_matrix(rest.rows(), rest.rows(), halves);
  std::vector<Eigen::Triplet<double>> entries;
  for (int v = 0; v < static_cast<int>(rest.rows()); ++v) entries.emplace_back(v, v, 0.0);
  for (int column = 0; column < edges.outerSize(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator edge(edges, column); edge; ++edge) {
      const int i = static_cast<int>(edge.row()), j = static_cast<int>(edge.col());
      const double weight = std::max(0.0, edge.value());
      entries.emplace_back(i, j, -weight);
      entries.emplace_back(j, i, -weight);
      entries.emplace_back(i, i, weight);
      entries.emplace_back(j, j, weight);
    }
  }
  return sparse_matrix(rest.rows(), rest.rows(), entries);
}

SkinSmoother::SkinSmoother(const Positions& rest, const Triangles& triangles, double radius)
    : areas_(lumped_areas(rest, triangles)) {
  Eigen::SparseMatrix<double> matrix = radius * radius / (2 * kSmoothingSteps) * cotangent_laplacian(rest, triangles);
  matrix.diagonal() += areas_;
  solver_ = SparseSolver(matrix);
}

Eigen::MatrixXd SkinSmoother::operator()(const Eigen::MatrixXd& values) const {
  Eigen::MatrixXd result = values;
  for (int step = 0; step < kSmoothingSteps; ++step) {
    const Eigen::MatrixXd right = areas_.asDiagonal() * result;  // solve() does not expect its result on both sides
    result = solver_.solve(right);
  }
  return result;
}

Eigen::MatrixXd smoothed(const Positions& rest, const Triangles& triangles, const Eigen::MatrixXd& values,
                         double radius) {
  return SkinSmoother(rest, triangles, radius)(values);
}

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
  std::ranges::sort(reached);
  std::vector<SurfacePlace> places;
  for (const std::uint32_t v : reached) places.push_back({v, distance[v]});
  return places;
}

}  // namespace bodyopt
