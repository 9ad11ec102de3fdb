#include "geometry/hat_gradients.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace bodyopt {

HatGradients hat_gradients(const Positions& vertices, const Triangles& triangles, Eigen::Index triangle) {
  const auto corner = [&](int k) -> Eigen::Vector3d { return vertices.row(triangles(triangle, k)); };
  const Eigen::Vector3d along = corner(1) - corner(0), across = corner(2) - corner(0);
  const Eigen::Vector3d twice = along.cross(across);
  const double area2 = twice.norm();
  HatGradients result;
  if (!(area2 > 1e-10 * std::max(along.squaredNorm(), across.squaredNorm()))) return result;
  result.normal = twice / area2;
  result.area = 0.5 * area2;
  for (int k = 0; k < 3; ++k) {
    result.of_corner.col(k) = result.normal.cross(corner((k + 2) % 3) - corner((k + 1) % 3)) / area2;
  }
  return result;
}

}  // namespace bodyopt
