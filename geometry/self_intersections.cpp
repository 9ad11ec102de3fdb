#include "geometry/self_intersections.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <set>
#include <tuple>

namespace bodyopt {
namespace {

using Eigen::Vector3d;
using CornerPoints = std::array<Vector3d, 3>;

constexpr double kFlat = 1e-12;  // height over the length of an edge

double six_volumes(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
  return (b - a).cross(c - a).dot(d - a);
}

bool passes_through(const Vector3d& from, const Vector3d& to, const CornerPoints& triangle) {
  const auto& [a, b, c] = triangle;
  const double start = six_volumes(a, b, c, from), end = six_volumes(a, b, c, to);
  // What lies in the plane but for rounding does not pass through it.
  const double least = kFlat * (b - a).cross(c - a).norm() * (to - from).norm();
  if (!(std::min(start, end) < -least && std::max(start, end) > least)) return false;
  const double ab = six_volumes(from, to, a, b), bc = six_volumes(from, to, b, c), ca = six_volumes(from, to, c, a);
  return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
}

class Intersections {
 public:
  Intersections(const Positions& vertices, const Triangles& triangles) : vertices_(vertices), triangles_(triangles) {
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
      const CornerPoints c = corners(t);
      boxes_.push_back({t, c[0].cwiseMin(c[1]).cwiseMin(c[2]), c[0].cwiseMax(c[1]).cwiseMax(c[2])});
    }
  }

  // Sweeps along the longest axis.
  std::vector<TrianglePair> find() {
    if (boxes_.empty()) return {};
    Eigen::Index axis = 0;
    (vertices_.colwise().maxCoeff() - vertices_.colwise().minCoeff()).maxCoeff(&axis);
    std::sort(boxes_.begin(), boxes_.end(), [axis](const Box& a, const Box& b) {
      return std::pair(a.low[axis], a.triangle) < std::pair(b.low[axis], b.triangle);
    });
    std::vector<TrianglePair> pairs;
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      for (std::size_t k = i + 1; k < boxes_.size() && boxes_[k].low[axis] <= boxes_[i].high[axis]; ++k) {
        const bool apart = (boxes_[k].low.array() > boxes_[i].high.array()).any() ||
                           (boxes_[i].low.array() > boxes_[k].high.array()).any();
        if (apart || !intersect(boxes_[i].triangle, boxes_[k].triangle)) continue;
        const auto [first, second] = std::minmax(boxes_[i].triangle, boxes_[k].triangle);
        pairs.push_back({first, second});
      }
    }
    std::sort(pairs.begin(), pairs.end(), [](const TrianglePair& a, const TrianglePair& b) {
      return std::tie(a.first, a.second) < std::tie(b.first, b.second);
    });
    return pairs;
  }

 private:
  struct Box {
    Eigen::Index triangle;
    Vector3d low, high;
  };
  CornerPoints corners(Eigen::Index t) const {
    return {vertices_.row(triangles_(t, 0)), vertices_.row(triangles_(t, 1)), vertices_.row(triangles_(t, 2))};
  }
  bool has_corner(Eigen::Index t, std::uint32_t vertex) const { return (triangles_.row(t).array() == vertex).any(); }

  // Does an edge of `a` that has no corner in common with `b` pass through b?
  bool pierces(Eigen::Index a, Eigen::Index b) const {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t from = triangles_(a, k), to = triangles_(a, (k + 1) % 3);
      if (has_corner(b, from) || has_corner(b, to)) continue;
      if (passes_through(vertices_.row(from), vertices_.row(to), corners(b))) return true;
    }
    return false;
  }
  bool intersect(Eigen::Index a, Eigen::Index b) const {
    int common = 0;
    for (int k = 0; k < 3; ++k) common += has_corner(b, triangles_(a, k)) ? 1 : 0;
    return common < 2 && (pierces(a, b) || pierces(b, a));
  }

  const Positions& vertices_;
  const Triangles& triangles_;
  std::vector<Box> boxes_;
};

}  // namespace

std::vector<TrianglePair> self_intersections(const Positions& vertices, const Triangles& triangles) {
  return Intersections(vertices, triangles).find();
}

std::vector<std::uint32_t> corners_of(const std::vector<TrianglePair>& pairs, const Triangles& triangles) {
  std::set<std::uint32_t> corners;
  for (const TrianglePair& pair : pairs) {
    for (const Eigen::Index t : {pair.first, pair.second}) {
      for (int k = 0; k < 3; ++k) corners.insert(triangles(t, k));
    }
  }
  return {corners.begin(), corners.end()};
}

}  // namespace bodyopt
