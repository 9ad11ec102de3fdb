#include "trainer/tets/apart_skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "geometry/closed_skin.h"

namespace bodyopt {

ApartSkin::ApartSkin(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights)
    : vertices_(vertices),
      weights_(weights),
      outwards_(enclosed_volume(vertices, triangles) < 0 ? -1 : 1),
      distance_(vertices.rows(), triangles) {}

std::vector<JointWeight> ApartSkin::weights_at(const SkinPoint& point) const {
  std::map<std::uint32_t, double> sums;
  for (int k = 0; k < 3; ++k) {
    for (const JointWeight& w : weights_[point.vertices[static_cast<std::size_t>(k)]]) {
      sums[w.joint] += point.weights[k] * w.weight;
    }
  }
  std::vector<JointWeight> result;
  for (const auto& [joint, weight] : sums) result.push_back({joint, weight});
  return result;
}

// How far behind the skin at the other, metres.
double ApartSkin::depth(const SkinPoint& point, const SkinPoint& other) const {
  const auto corner = [&](std::size_t k) -> Eigen::Vector3d { return vertices_.row(other.vertices[k]); };
  const Eigen::Vector3d normal = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
  return (other.position - point.position).dot(normal) * outwards_;
}

bool ApartSkin::operator()(const SkinPoint& a, const SkinPoint& b, double overlap) const {
  if (shared_weight(weights_at(a), weights_at(b)) >= kSharedByOne) return false;
  if (std::max(depth(a, b), depth(b, a)) > overlap) return false;
  const auto is_of_b = [&](std::uint32_t v) {
    return std::find(b.vertices.begin(), b.vertices.end(), v) != b.vertices.end();
  };
  // No way over a corner is as short as that straight through one triangle or two.
  if (std::any_of(a.vertices.begin(), a.vertices.end(), is_of_b)) return false;
  const double farthest = kDetour * (a.position - b.position).norm();
  const std::vector<SurfacePlace> near = distance_.around(vertices_, a, farthest);
  return std::none_of(near.begin(), near.end(), [&](const SurfacePlace& place) {
    return is_of_b(place.vertex) &&
           place.distance + (vertices_.row(place.vertex).transpose() - b.position).norm() <= farthest;
  });
}

}  // namespace bodyopt
