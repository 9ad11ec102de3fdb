#include "geometry/skin_in_skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/parallel.h"
#include "geometry/self_intersections.h"
#include "geometry/surface_distance.h"
#include "geometry/vertex_normals.h"

namespace bodyopt {
namespace {

constexpr double kOutside = 1e-6;  // metres

class BodyInside {
 public:
  BodyInside(const Positions& vertices, const Triangles& triangles) : vertices_(vertices), triangles_(triangles) {}

  // Along an axis, forwards and back: the winding number by the skin that is passed on the way out. Of an open skin one
  // of the ways may lead through the opening.
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

  // Does the edge cross the ray from the point along u, seen along the axis? Of an edge from either end the same.
  static int crosses(const Eigen::RowVector3d& from, const Eigen::RowVector3d& to, const Eigen::RowVector3d& point,
                     int u, int v) {
    if ((from[v] > point[v]) == (to[v] > point[v])) return 0;
    const auto [low, high] = from[v] < to[v] ? std::tie(from, to) : std::tie(to, from);
    return point[u] < low[u] + (high[u] - low[u]) * ((point[v] - low[v]) / (high[v] - low[v])) ? 1 : 0;
  }

  const Positions& vertices_;
  const Triangles& triangles_;
};

}  // namespace

std::vector<BuriedVertex> skin_in_skin(const Positions& vertices, const Triangles& triangles,
                                       const Triangles& searched) {
  std::vector<std::uint32_t> front;
  std::vector<char> seen(static_cast<std::size_t>(vertices.rows()), 0);
  const auto reach = [&](std::uint32_t v) {
    if (!seen[v]) front.push_back(v);
    seen[v] = 1;
  };
  for (const TrianglePair& pair : self_intersections(vertices, searched)) {
    for (int k = 0; k < 3; ++k) {
      reach(searched(pair.first, k));
      reach(searched(pair.second, k));
    }
  }
  if (front.empty()) return {};
  const Positions normals = vertex_normals(vertices, triangles).rowwise().normalized();
  const BodyInside inside(vertices, triangles);
  const SurfaceDistance around(vertices.rows(), triangles);
  std::vector<std::uint32_t> buried;
  while (!front.empty()) {  // as far as vertices are buried, ring by ring
    std::vector<char> in(front.size());
    parallel_for(front.size(), [&](std::size_t k) {
      const Eigen::RowVector3d normal = normals.row(front[k]);
      int axis = 0;
      normal.cwiseAbs().maxCoeff(&axis);
      in[k] = inside(vertices.row(front[k]) + kOutside * normal, axis);
    });
    const std::vector<std::uint32_t> tested = std::move(front);
    front.clear();
    for (std::size_t k = 0; k < tested.size(); ++k) {
      if (!in[k]) continue;
      buried.push_back(tested[k]);
      around.visit_ring(tested[k], reach);
    }
  }
  std::sort(buried.begin(), buried.end());
  std::vector<char> is_buried(seen.size(), 0);
  for (const std::uint32_t v : buried) is_buried[v] = 1;
  std::vector<Eigen::Index> sides;  // what lies twice in the body ends at them
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    if (is_buried[triangles(t, 0)] || is_buried[triangles(t, 1)] || is_buried[triangles(t, 2)]) sides.push_back(t);
  }
  if (sides.empty()) return {};
  const Triangles around_it = triangles(sides, Eigen::all);
  const NearestSkin nearest(vertices, around_it);
  std::vector<BuriedVertex> found(buried.size());
  parallel_for(buried.size(), [&](std::size_t k) {
    const Eigen::Vector3d point = vertices.row(buried[k]).transpose();
    SkinPoint skin = nearest.behind(point);
    if (skin.triangle >= 0) skin.triangle = sides[static_cast<std::size_t>(skin.triangle)];
    found[k] = {buried[k], (skin.position - point).norm(), skin};
  });
  std::erase_if(found, [](const BuriedVertex& vertex) { return vertex.skin.triangle < 0; });
  return found;
}

}  // namespace bodyopt
