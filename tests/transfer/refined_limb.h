// The synthetic limb in finer triangles.
#pragma once

#include <map>

#include "tests/support/capsule_limb.h"

namespace bodyopt {

// Every triangle in four, by the middles of its edges.
inline Character refined_limb() {
  Character limb = limb_character();
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  std::vector<Eigen::RowVector3d> points;
  for (Eigen::Index v = 0; v < limb.vertices.rows(); ++v) points.push_back(limb.vertices.row(v));
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [entry, added] = middles.emplace(std::minmax(a, b), static_cast<std::uint32_t>(points.size()));
    if (added) points.push_back(0.5 * (points[a] + points[b]));
    return entry->second;
  };
  std::vector<std::uint32_t> corners;
  for (Eigen::Index t = 0; t < limb.triangles.rows(); ++t) {
    const std::uint32_t a = limb.triangles(t, 0), b = limb.triangles(t, 1), c = limb.triangles(t, 2);
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    corners.insert(corners.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
  }
  limb.vertices.resize(static_cast<Eigen::Index>(points.size()), 3);
  limb.weights.clear();
  limb.output_vertex.clear();
  for (std::size_t v = 0; v < points.size(); ++v) {
    limb.vertices.row(static_cast<Eigen::Index>(v)) = points[v];
    limb.weights.push_back(limb_weights(points[v].z()));
    limb.output_vertex.push_back(static_cast<std::uint32_t>(v));
  }
  limb.triangles = Eigen::Map<const Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
  limb.output_triangles = limb.triangles;
  return limb;
}

}  // namespace bodyopt
