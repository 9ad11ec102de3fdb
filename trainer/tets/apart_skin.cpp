#include "trainer/tets/apart_skin.h"

#include <algorithm>
#include <map>

namespace bodyopt {

ApartSkin::ApartSkin(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights)
    : vertices_(vertices), weights_(weights), distance_(vertices.rows(), triangles) {}

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

bool ApartSkin::operator()(const SkinPoint& a, const SkinPoint& b) const {
  if (shared_weight(weights_at(a), weights_at(b)) >= kSharedByOne) return false;
  const double farthest = kDetour * (a.position - b.position).norm();
  const std::vector<SurfacePlace> near = distance_.around(vertices_, a, farthest);
  return std::none_of(near.begin(), near.end(), [&](const SurfacePlace& place) {
    return std::find(b.vertices.begin(), b.vertices.end(), place.vertex) != b.vertices.end() &&
           place.distance + (vertices_.row(place.vertex).transpose() - b.position).norm() <= farthest;
  });
}

}  // namespace bodyopt
