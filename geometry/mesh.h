// Points, triangles and how joints hold points: geometry is computed on them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace bodyopt {

using Positions = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;         // #V x 3
using Triangles = Eigen::Matrix<std::uint32_t, Eigen::Dynamic, 3, Eigen::RowMajor>;  // #T x 3

struct JointWeight {
  std::uint32_t joint;
  double weight;
};
using SkinWeights = std::vector<std::vector<JointWeight>>;  // V

// How much of their weights two vertices have in common: from 0, of different joints, to 1, of the same alike.
double shared_weight(const std::vector<JointWeight>& a, const std::vector<JointWeight>& b);

// Calls visit(a, b) for the three edges of every triangle, as it runs around them.
void for_each_edge(const Triangles& triangles, const auto& visit) {
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) visit(triangles(t, k), triangles(t, (k + 1) % 3));
  }
}

// The positions of a triangle's corners.
using CornerPoints = std::array<Eigen::Vector3d, 3>;
inline CornerPoints corners_of(const Positions& vertices, const Triangles& triangles, Eigen::Index t) {
  return {vertices.row(triangles(t, 0)), vertices.row(triangles(t, 1)), vertices.row(triangles(t, 2))};
}
double triangle_area(const Positions& vertices, const Triangles& triangles, Eigen::Index t);

// Corners, a triangle each.
Triangles triangles_of(const std::vector<std::array<std::uint32_t, 3>>& corners);

// The sum of the normals of the triangles around each vertex, each twice its area long, V x 3; zero without any.
[[nodiscard]] Positions vertex_normals(const Positions& vertices, const Triangles& triangles);
// The same, of length 1; up where a vertex has no area around it.
[[nodiscard]] Positions unit_normals(const Positions& vertices, const Triangles& triangles);

// Extents of the bounding box, in the points' unit; 0 without points.
Eigen::RowVector3d box_sides(const Positions& points);
double longest_extent(const Positions& points);
double box_diagonal(const Positions& points);

// Tables of a basis as matrices, and back.

// Points, #V x 3.
inline Positions rows_of(const std::vector<float>& values) {
  return Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(
             values.data(), static_cast<Eigen::Index>(values.size() / 3), 3)
      .cast<double>();
}

inline Triangles rows_of(const std::vector<std::uint32_t>& corners) {
  return Eigen::Map<const Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
}

// 3 V.
inline std::vector<float> floats_of(const Positions& points) { return {points.data(), points.data() + points.size()}; }

}  // namespace bodyopt
