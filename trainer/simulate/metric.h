// The constant metric the solver measures steps in: a scalar Laplacian weighted by stiffness, factored once.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "geometry/tet_mesh.h"
#include "trainer/simulate/factor_panels.h"
#include "trainer/simulate/materials.h"

namespace bodyopt {

using SparseMatrix = Eigen::SparseMatrix<double>;

// Volume-weighted P1 stiffness matrix: sum over tets of coefficient x volume x (slope_a . slope_b), N x N.
SparseMatrix tet_laplacian(const TetMesh& mesh, const std::vector<double>& coefficients);

// Stiffness of each tet in the metric, Pa: an estimate of the elastic Hessian's size that holds in every pose, so that
// L-BFGS takes full steps (Liu, Bouaziz, Kavan 2017). muscle: share of each tet that is muscle.
std::vector<double> metric_stiffness(const std::vector<TetMaterial>& tets, const std::vector<double>& muscle,
                                     const Materials& materials);

// A sparse Cholesky factor of a positive definite matrix, and its solve with three right sides at once. The factor is
// kept in single precision: a metric needs no more digits, and reading it is what a solve costs.
class Metric {
 public:
  using Scratch = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;  // the fourth right side is zero

  explicit Metric(const SparseMatrix& matrix);
  // Replaces `values` (N x 3) by the inverse metric times it. `scratch` is resized as needed.
  void solve(Positions& values, Scratch& scratch) const;

 private:
  std::vector<int> order_;  // original index of each row of the factor
  FactorPanels panels_;
};

}  // namespace bodyopt
