#include "geometry/nearest_skin.h"

#include <Eigen/Geometry>
#include <limits>
#include <map>

#include "geometry/spatial_search.h"

namespace bodyopt {
namespace {

// Barycentric weights of the point of triangle abc nearest to p (Ericson, Real-Time Collision Detection, 5.1.5).
Eigen::Vector3d nearest_weights(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double t = d1 - d3 > 0 ? d1 / (d1 - d3) : 0;
    return {1 - t, t, 0};
  }
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double t = d2 - d6 > 0 ? d2 / (d2 - d6) : 0;
    return {1 - t, 0, t};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double edge = (d4 - d3) + (d5 - d6), t = edge > 0 ? (d4 - d3) / edge : 0;
    return {0, 1 - t, t};
  }
  const double sum = va + vb + vc;
  if (!(sum > 0)) return {1, 0, 0};
  return {va / sum, vb / sum, vc / sum};
}

}  // namespace

NearestSkin::NearestSkin(const Positions& vertices, const Triangles& triangles)
    : vertices_(vertices),
      triangles_(triangles),
      largest_coordinate_(vertices.cwiseAbs().maxCoeff()),
      tree_(std::make_unique<BoxTree>(boxes_of(vertices, triangles))) {}

NearestSkin::~NearestSkin() = default;

template <typename Wanted>
SkinPoint NearestSkin::search(const Eigen::Vector3d& point, const Wanted& wanted) const {
  SkinPoint best;
  double least = std::numeric_limits<double>::infinity();
  const auto consider = [&](int t) {
    const auto corners = triangles_.row(t);
    const Eigen::Vector3d a = vertices_.row(corners[0]), b = vertices_.row(corners[1]), c = vertices_.row(corners[2]);
    if (!wanted(a, b, c)) return least;
    const Eigen::Vector3d weights = nearest_weights(point, a, b, c);
    const Eigen::Vector3d position = weights[0] * a + weights[1] * b + weights[2] * c;
    const double distance = (position - point).norm();
    if (distance < least || (distance == least && t < best.triangle)) {
      best = {t, {corners[0], corners[1], corners[2]}, weights, position};
      least = distance;
    }
    return least;
  };
  // Less by what roundings of coordinates come to, so that what is as near as the nearest is considered, too.
  const double slack = 1e-14 * (largest_coordinate_ + point.cwiseAbs().maxCoeff());
  const auto bound = [&](const Eigen::AlignedBox3d& box) { return box.exteriorDistance(point) - slack; };
  tree_->search(bound, consider, least);
  return best;
}

std::vector<JointWeight> weights_at(const SkinWeights& weights, const SkinPoint& at) {
  std::map<std::uint32_t, double> sums;
  for (int k = 0; k < 3; ++k) {
    if (at.weights[k] == 0) continue;
    for (const auto& [joint, weight] : weights[at.vertices[static_cast<std::size_t>(k)]]) {
      sums[joint] += at.weights[k] * weight;
    }
  }
  std::vector<JointWeight> result;
  for (const auto& [joint, weight] : sums) result.push_back({joint, weight});
  return result;
}

SkinPoint NearestSkin::operator()(const Eigen::Vector3d& point) const {
  return search(point, [](const auto&...) { return true; });
}

SkinPoint NearestSkin::facing(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
  return search(point, [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    return (b - a).cross(c - a).dot(normal) > 0;
  });
}

}  // namespace bodyopt
