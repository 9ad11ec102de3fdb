// What geometry is computed on: points, triangles, and how joints hold points.
#pragma once

#include <Eigen/Core>
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

// The sum of the normals of the triangles around each vertex, each twice its area long, V x 3; zero without any.
[[nodiscard]] Positions vertex_normals(const Positions& vertices, const Triangles& triangles);

// Of the bounding box, in the points' unit; 0 of no points.
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
