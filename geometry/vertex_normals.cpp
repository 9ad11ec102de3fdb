#include "geometry/vertex_normals.h"

#include <Eigen/Geometry>

namespace bodyopt {

Positions vertex_normals(const Positions& vertices, const Triangles& triangles) {
  Positions normals = Positions::Zero(vertices.rows(), 3);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::RowVector3d a = vertices.row(triangles(t, 0)), b = vertices.row(triangles(t, 1)),
                             c = vertices.row(triangles(t, 2));
    const Eigen::RowVector3d normal = (b - a).cross(c - a);
    for (int k = 0; k < 3; ++k) normals.row(triangles(t, k)) += normal;
  }
  return normals;
}

}  // namespace bodyopt
