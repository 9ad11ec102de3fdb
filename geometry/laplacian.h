// Discrete operators of a triangle mesh.
#pragma once

#include <Eigen/SparseCore>

#include "base/linear_algebra.h"
#include "geometry/mesh.h"

namespace bodyopt {

// A third of the area of the triangles around each vertex, square metres, not below 1e-3 of the mean. V
Eigen::VectorXd lumped_areas(const Positions& rest, const Triangles& triangles);

// Cotangent Laplacian, V x V, positive semi-definite: half the sum of the opposite cotangents per edge, that sum
// clamped at zero from below. Degenerate triangles add nothing.
Eigen::SparseMatrix<double> cotangent_laplacian(const Positions& rest, const Triangles& triangles);

// Diffusion over a skin by a Gaussian of one deviation (metres), in implicit steps, factorised once.
class SkinSmoother {
 public:
  SkinSmoother(const Positions& rest, const Triangles& triangles, double radius);
  // V x any; every column keeps its integral over the skin. On any thread.
  Eigen::MatrixXd operator()(const Eigen::MatrixXd& values) const;

 private:
  Eigen::VectorXd areas_;
  SparseSolver solver_;
};

// The same, once.
[[nodiscard]] Eigen::MatrixXd smoothed(const Positions& rest, const Triangles& triangles, const Eigen::MatrixXd& values,
                                       double radius);

}  // namespace bodyopt
