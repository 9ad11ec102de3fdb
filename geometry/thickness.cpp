#include "geometry/thickness.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/parallel.h"
#include "geometry/mend_surface.h"
#include "geometry/mesh.h"
#include "geometry/spatial_search.h"

namespace bodyopt {
namespace {

constexpr double kThinnest = 1.0 / 180, kThickest = 1.0 / 6;  // of the body's extent
constexpr double kFewestRounds = 1, kMostRounds = 200;
constexpr double kEdge = 1e-9;  // barycentric: rays must not slip through between two triangles
constexpr Eigen::Index kMostRays = 16384;

struct RayTriangle {
  Eigen::Vector3d origin, first, second;  // a corner, and the edges from it
};

// Distance along a ray of unit direction to a triangle; infinite where it misses (Moeller, Trumbore 1997).
double hit(const RayTriangle& triangle, const Eigen::Vector3d& origin, const Eigen::Vector3d& along) {
  constexpr double kMissed = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d p = along.cross(triangle.second);
  const double determinant = triangle.first.dot(p);
  if (determinant == 0) return kMissed;
  const Eigen::Vector3d s = origin - triangle.origin;
  const double u = s.dot(p) / determinant;
  const Eigen::Vector3d q = s.cross(triangle.first);
  const double v = along.dot(q) / determinant, distance = triangle.second.dot(q) / determinant;
  const bool inside = u > -kEdge && v > -kEdge && u + v < 1 + kEdge;
  return inside && distance > 0 ? distance : kMissed;
}

// Distance along a ray at which it may enter a box; infinite where it passes by (slabs: Kay, Kajiya 1986).
double entry(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& origin, const Eigen::Vector3d& along) {
  const double slack = 4 * kEdge * box.diagonal().norm();
  double from = 0, to = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double low = box.min()[axis] - slack - origin[axis], high = box.max()[axis] + slack - origin[axis];
    if (along[axis] == 0) {
      if (low > 0 || high < 0) return std::numeric_limits<double>::infinity();
      continue;
    }
    const auto [near, far] = std::minmax({low / along[axis], high / along[axis]});
    from = std::max(from, near);
    to = std::min(to, far);
  }
  return from <= to ? from : std::numeric_limits<double>::infinity();
}

// Each round averages over a vertex and its neighbours and so widens the average by about an edge's square.
void smooth(const Triangles& triangles, int rounds, Eigen::VectorXd& values) {
  for (int k = 0; k < rounds; ++k) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(values.size()), count = Eigen::VectorXd::Zero(values.size());
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
      for (int a = 0; a < 3; ++a) {
        sum[triangles(t, a)] += values[triangles(t, 0)] + values[triangles(t, 1)] + values[triangles(t, 2)];
        count[triangles(t, a)] += 3;
      }
    }
    for (Eigen::Index v = 0; v < values.size(); ++v) values[v] = count[v] > 0 ? sum[v] / count[v] : values[v];
  }
}

// Triangles that rays are shot at.
class RayTarget {
 public:
  RayTarget(const Positions& vertices, const Triangles& triangles)
      : triangles_(triangles), tree_(boxes_of(vertices, triangles)) {
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
      const auto [a, b, c] = corners_of(vertices, triangles, t);
      corners_.push_back({a, b - a, c - a});
    }
  }

  // The nearest hit of a ray from a vertex, or `farthest`.
  double distance(Eigen::Index vertex, const Eigen::Vector3d& origin, const Eigen::Vector3d& along,
                  double farthest) const {
    const auto consider = [&](int t) {
      const auto of = triangles_.row(t).cast<Eigen::Index>();
      const bool starts_there = of[0] == vertex || of[1] == vertex || of[2] == vertex;
      if (!starts_there) farthest = std::min(farthest, hit(corners_[static_cast<std::size_t>(t)], origin, along));
      return farthest;
    };
    tree_.search([&](const Eigen::AlignedBox3d& box) { return entry(box, origin, along); }, consider, farthest);
    return farthest;
  }

 private:
  const Triangles& triangles_;
  BoxTree tree_;
  std::vector<RayTriangle> corners_;
};

}  // namespace

Eigen::VectorXd thickness(const Positions& vertices, const Triangles& triangles, double nearby) {
  const double inwards = enclosed_volume(vertices, triangles) < 0 ? 1 : -1;
  const Positions normals = vertex_normals(vertices, triangles);
  const RayTarget target(vertices, triangles);
  const double extent = longest_extent(vertices);
  const Eigen::Index stride = (vertices.rows() + kMostRays - 1) / kMostRays;
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(vertices.rows()), count = Eigen::VectorXd::Zero(vertices.rows());
  parallel_for(static_cast<std::size_t>((vertices.rows() + stride - 1) / stride), [&](std::size_t n) {
    const Eigen::Index v = static_cast<Eigen::Index>(n) * stride;
    const Eigen::Vector3d along = inwards * normals.row(v).transpose();
    if (!(along.norm() > 0)) return;
    sum[v] = std::max(target.distance(v, vertices.row(v), along.normalized(), kThickest * extent), kThinnest * extent);
    count[v] = 1;
  });
  const double rounds = std::pow(nearby * extent / mean_edge(vertices, triangles), 2);
  for (Eigen::VectorXd* values : {&sum, &count})
    smooth(triangles, static_cast<int>(std::clamp(rounds, kFewestRounds, kMostRounds)), *values);
  return (count.array() > 0).select(sum.array() / count.array(), kThinnest * extent);
}

Eigen::VectorXd half_thickness(const Positions& vertices, const Triangles& triangles, const NearestSkin& skin) {
  constexpr double kFirstStep = 1.0 / 600, kFarthest = 0.12;  // of the body's extent
  constexpr double kStep = 1.15, kKeepsUp = 0.8;
  const double extent = longest_extent(vertices);
  const double inwards = enclosed_volume(vertices, triangles) < 0 ? 1 : -1;
  const Positions normals = vertex_normals(vertices, triangles);
  Eigen::VectorXd thickness = Eigen::VectorXd::Zero(vertices.rows());
  parallel_for_short(static_cast<std::size_t>(vertices.rows()), [&](std::size_t n) {
    const auto v = static_cast<Eigen::Index>(n);
    const Eigen::Vector3d from = vertices.row(v), along = inwards * normals.row(v).transpose().normalized();
    for (double way = kFirstStep * extent; way < kFarthest * extent; way *= kStep) {
      const Eigen::Vector3d point = from + way * along;
      const double depth = (skin(point).position - point).norm();
      thickness[v] = std::max(thickness[v], depth);
      if (depth < kKeepsUp * way) break;
    }
  });
  return thickness;
}

using Eigen::Vector3d;

SkinDepth::SkinDepth(const Positions& vertices, const Triangles& triangles)
    : vertices_(vertices), triangles_(triangles), nearest_(vertices, triangles) {}

// The sum of the triangles' solid angles (Van Oosterom, Strackee 1983).
double SkinDepth::winding_number(const Vector3d& point) const {
  double sum = 0;
  for (Eigen::Index t = 0; t < triangles_.rows(); ++t) {
    const auto [x, y, z] = corners_of(vertices_, triangles_, t);
    const Vector3d a = x - point, b = y - point, c = z - point;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (2 * std::numbers::pi);
}

double SkinDepth::operator()(const Vector3d& point) const {
  const double distance = (nearest_(point).position - point).norm();
  return std::abs(winding_number(point)) > 0.5 ? distance : -distance;
}

std::optional<Vector3d> SkinDepth::tuck(const Vector3d& point, double depth) const {
  const double here = (*this)(point);
  if (here >= depth) return point;
  const SkinPoint skin = nearest_(point);
  const auto [a, b, c] = corners_of(vertices_, triangles_, skin.triangle);
  Vector3d inward = -(b - a).cross(c - a).normalized();
  if (std::abs(here) > 1e-6) inward = (here > 0 ? 1 : -1) * (point - skin.position).normalized();
  Vector3d best = point;
  double deepest = here;
  for (int halvings = 0; halvings < 6; ++halvings, depth /= 2) {
    const Vector3d candidate = skin.position + depth * inward;
    const double reached = (*this)(candidate);
    if (reached > deepest) {
      best = candidate;
      deepest = reached;
    }
    if (deepest > 0.7 * depth) return best;
  }
  if (!(deepest > 0)) return std::nullopt;
  return best;
}

}  // namespace bodyopt
