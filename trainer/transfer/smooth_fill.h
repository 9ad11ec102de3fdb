// Values of some vertices of a skin, filled in smoothly from all others.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "base/linear_algebra.h"
#include "geometry/mesh.h"

namespace bodyopt {

// Harmonic in the cotangent Laplacian (weight inpainting as of Abdrashitov and others 2023). One factorisation, made on
// construction.
class SmoothFill {
 public:
  // `skin`: V x 3; `unknown`: the vertices to fill in, rising.
  SmoothFill(const Positions& skin, const Triangles& triangles, std::vector<int> unknown);

  // V x any: changes the rows of `unknown`. Where nothing around is known, as in a piece of its own, they take their
  // mean by area. On any thread.
  void operator()(Eigen::MatrixXd& values) const;

  const std::vector<int>& unknown() const { return unknown_; }

 private:
  std::vector<int> unknown_;
  Eigen::VectorXd anchors_;                 // per unknown vertex, so small that only a piece of its own feels it
  Eigen::SparseMatrix<double> from_known_;  // unknown x V
  SparseSolver solver_;
};

// Rows whose value is below `least`, rising.
std::vector<int> rows_below(const Eigen::VectorXd& values, double least);

}  // namespace bodyopt
