// Gradients of linear functions on triangles.
#pragma once

#include "geometry/mesh.h"

namespace bodyopt {

struct HatGradients {
  Eigen::Matrix3d of_corner =
      Eigen::Matrix3d::Zero();                       // column k: gradient, 1/m, of what is 1 at corner k, 0 at others
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // of unit length, counter-clockwise seen from outside
  double area = 0;                                   // square metres
};

// Of one triangle; all zero where it is degenerate.
HatGradients hat_gradients(const Positions& vertices, const Triangles& triangles, Eigen::Index triangle);

}  // namespace bodyopt
