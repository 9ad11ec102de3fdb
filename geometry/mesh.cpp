#include "geometry/mesh.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace bodyopt {

double shared_weight(const std::vector<JointWeight>& a, const std::vector<JointWeight>& b) {
  double sum = 0;
  for (const JointWeight& wa : a) {
    for (const JointWeight& wb : b) sum += wa.joint == wb.joint ? std::min(wa.weight, wb.weight) : 0;
  }
  return sum;
}

double triangle_area(const Positions& vertices, const Triangles& triangles, Eigen::Index t) {
  const auto [a, b, c] = corners_of(vertices, triangles, t);
  return (b - a).cross(c - a).norm() / 2;
}

Triangles triangles_of(const std::vector<std::array<std::uint32_t, 3>>& corners) {
  Triangles triangles(static_cast<Eigen::Index>(corners.size()), 3);
  for (Eigen::Index k = 0; k < triangles.size(); ++k)
    triangles.data()[k] = corners[static_cast<std::size_t>(k / 3)][static_cast<std::size_t>(k % 3)];
  return triangles;
}

Positions vertex_normals(const Positions& vertices, const Triangles& triangles) {
  Positions normals = Positions::Zero(vertices.rows(), 3);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const auto [a, b, c] = corners_of(vertices, triangles, t);
    const Eigen::RowVector3d normal = (b - a).cross(c - a);
    for (int k = 0; k < 3; ++k) normals.row(triangles(t, k)) += normal;
  }
  return normals;
}

Positions unit_normals(const Positions& vertices, const Triangles& triangles) {
  Positions normals = vertex_normals(vertices, triangles);
  for (Eigen::Index v = 0; v < normals.rows(); ++v) {
    const double size = normals.row(v).norm();
    if (size > 1e-30) {
      normals.row(v) /= size;
    } else {
      normals.row(v) << 0, 1, 0;
    }
  }
  return normals;
}

Eigen::RowVector3d box_sides(const Positions& points) {
  if (points.rows() == 0) return Eigen::RowVector3d::Zero();
  return points.colwise().maxCoeff() - points.colwise().minCoeff();
}

double longest_extent(const Positions& points) { return box_sides(points).maxCoeff(); }

double box_diagonal(const Positions& points) { return box_sides(points).norm(); }

}  // namespace bodyopt
