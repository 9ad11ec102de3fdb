#include "geometry/self_intersections.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <set>
#include <tuple>

#include "base/parallel.h"
#include "geometry/nearest_skin.h"
#include "geometry/surface_distance.h"

namespace bodyopt {
namespace {

using Eigen::Vector3d;

constexpr double kFlat = 1e-12;  // height over the length of an edge

double six_volumes(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
  return (b - a).cross(c - a).dot(d - a);
}

bool passes_through(const Vector3d& from, const Vector3d& to, const CornerPoints& triangle) {
  const auto& [a, b, c] = triangle;
  const double start = six_volumes(a, b, c, from), end = six_volumes(a, b, c, to);
  // An edge that lies in the plane but for rounding does not pass through it.
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
    std::ranges::sort(boxes_, [axis](const Box& a, const Box& b) {
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
    std::ranges::sort(pairs, [](const TrianglePair& a, const TrianglePair& b) {
      return std::tie(a.first, a.second) < std::tie(b.first, b.second);
    });
    return pairs;
  }

 private:
  struct Box {
    Eigen::Index triangle;
    Vector3d low, high;
  };
  CornerPoints corners(Eigen::Index t) const { return corners_of(vertices_, triangles_, t); }
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

constexpr double kOutside = 1e-6;  // metres

class BodyInside {
 public:
  BodyInside(const Positions& vertices, const Triangles& triangles) : vertices_(vertices), triangles_(triangles) {}

  // Counts the winding number by the skin that is passed on the way out, along an axis, forwards and back. One of the
  // ways may lead through the opening of an open skin.
  bool operator()(const Eigen::RowVector3d& point, int axis) const {
    int forwards = 0, back = 0;
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (Eigen::Index t = 0; t < triangles_.rows(); ++t) {
      const Eigen::RowVector3d a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
      if (!(std::min({a[v], b[v], c[v]}) <= point[v] && std::max({a[v], b[v], c[v]}) >= point[v])) continue;
      if (crosses(a, b, point, u, v) + crosses(b, c, point, u, v) + crosses(c, a, point, u, v) != 1) continue;
      const Eigen::RowVector3d normal = (b - a).cross(c - a);
      if (normal[axis] == 0) continue;
      const double side = (a - point).dot(normal) / normal[axis];
      const int way = normal[axis] > 0 ? 1 : -1;
      if (side > 0) {
        forwards += way;
      } else {
        back -= way;
      }
    }
    return std::min(forwards, back) >= 1;
  }

 private:
  Eigen::RowVector3d corner(Eigen::Index t, int k) const { return vertices_.row(triangles_(t, k)); }

  // Does the edge cross the ray from the point along u, seen along the axis? The result is the same from either end.
  static int crosses(const Eigen::RowVector3d& from, const Eigen::RowVector3d& to, const Eigen::RowVector3d& point,
                     int u, int v) {
    if ((from[v] > point[v]) == (to[v] > point[v])) return 0;
    const auto [low, high] = from[v] < to[v] ? std::tie(from, to) : std::tie(to, from);
    return point[u] < low[u] + (high[u] - low[u]) * ((point[v] - low[v]) / (high[v] - low[v])) ? 1 : 0;
  }

  const Positions& vertices_;
  const Triangles& triangles_;
};

// Grows, ring by ring, from the vertices of triangles that pass through each other as far as vertices are buried.
class BuriedSkin {
 public:
  BuriedSkin(const Positions& vertices, const Triangles& triangles)
      : vertices_(vertices),
        triangles_(triangles),
        normals_(vertex_normals(vertices, triangles).rowwise().normalized()),
        crosses_(static_cast<std::size_t>(triangles.rows()), 0),
        seen_(static_cast<std::size_t>(vertices.rows()), 0),
        buried_(seen_) {
    for (const TrianglePair& pair : self_intersections(vertices, triangles)) {
      for (const Eigen::Index t : {pair.first, pair.second}) {
        crosses_[static_cast<std::size_t>(t)] = 1;
        for (int k = 0; k < 3; ++k) reach(triangles(t, k));
      }
    }
    grow();
  }

  std::vector<BuriedVertex> with_depths() const {
    const Triangles near = triangles_(triangles_there(), Eigen::all);
    if (near.rows() == 0) return {};
    const NearestSkin nearest(vertices_, near);
    std::vector<BuriedVertex> found;
    for (std::uint32_t v = 0; v < buried_.size(); ++v) {
      if (buried_[v]) found.push_back({v, 0});
    }
    parallel_for(found.size(), [&](std::size_t k) {
      const Eigen::Vector3d point = vertices_.row(found[k].vertex).transpose();
      const SkinPoint skin = nearest.facing(point, Eigen::Vector3d(-normals_.row(found[k].vertex).transpose()));
      if (skin.triangle >= 0) found[k].depth = (skin.position - point).norm();
    });
    return found;
  }

 private:
  void reach(std::uint32_t v) {
    if (!seen_[v]) front_.push_back(v);
    seen_[v] = 1;
  }

  void grow() {
    const BodyInside inside(vertices_, triangles_);
    const SurfaceDistance around(vertices_.rows(), triangles_);
    while (!front_.empty()) {
      const std::vector<std::uint32_t> tested = std::move(front_);
      front_.clear();
      parallel_for(tested.size(), [&](std::size_t k) {
        const Eigen::RowVector3d normal = normals_.row(tested[k]);
        int axis = 0;
        normal.cwiseAbs().maxCoeff(&axis);
        buried_[tested[k]] = inside(vertices_.row(tested[k]) + kOutside * normal, axis);
      });
      for (const std::uint32_t v : tested) {
        if (buried_[v]) around.visit_ring(v, [&](std::uint32_t next) { reach(next); });
      }
    }
  }

  // Triangles where skin lies in skin.
  std::vector<Eigen::Index> triangles_there() const {
    std::vector<Eigen::Index> found;
    for (Eigen::Index t = 0; t < triangles_.rows(); ++t) {
      const bool there = crosses_[static_cast<std::size_t>(t)] || buried_[triangles_(t, 0)] ||
                         buried_[triangles_(t, 1)] || buried_[triangles_(t, 2)];
      if (there) found.push_back(t);
    }
    return found;
  }

  const Positions& vertices_;
  const Triangles& triangles_;
  const Positions normals_;
  std::vector<char> crosses_;  // T
  std::vector<char> seen_, buried_;
  std::vector<std::uint32_t> front_;
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

std::vector<BuriedVertex> skin_in_skin(const Positions& vertices, const Triangles& triangles) {
  return BuriedSkin(vertices, triangles).with_depths();
}

}  // namespace bodyopt
