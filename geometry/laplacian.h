// Discrete operators of a triangle mesh.
#pragma once

#include <Eigen/SparseCore>

#include "geometry/mesh.h"

namespace bodyopt {

// A third of the area of the triangles around each vertex, square metres, not below 1e-3 of the mean. V
Eigen::VectorXd lumped_areas(const Positions& rest, const Triangles& triangles);

// Cotangent Laplacian, V x V, positive semi-definite: half the sum of the opposite cotangents per edge, that sum
// clamped at zero from below. Degenerate triangles add nothing.
Eigen::SparseMatrix<double> cotangent_laplacian(const Positions& rest, const Triangles& triangles);

// V x any: the values after a diffusion by a Gaussian of this deviation (metres), in implicit steps; every column keeps
// its integral over the skin.
Eigen::MatrixXd smoothed(const Positions& rest, const Triangles& triangles, const Eigen::MatrixXd& values,
                         double radius);

}  // namespace bodyopt
