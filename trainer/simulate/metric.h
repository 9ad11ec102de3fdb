// The constant metric the solver measures steps in: a scalar Laplacian weighted by stiffness.
#pragma once

#include <Eigen/SparseCore>
#include <optional>
#include <vector>

#include "geometry/tet_mesh.h"
#include "trainer/factor/factor_panels.h"
#include "trainer/simulate/gauss_seidel.h"
#include "trainer/simulate/materials.h"

namespace bodyopt::trainer {

using SparseMatrix = Eigen::SparseMatrix<double>;

// Volume-weighted P1 stiffness matrix: sum over tets of coefficient x volume x (slope_a . slope_b), N x N.
SparseMatrix tet_laplacian(const TetMesh& mesh, const std::vector<double>& coefficients);

// Stiffness of each tet in the metric, Pa. It estimates the size of the elastic Hessian in every pose, so that L-BFGS
// takes full steps (Liu, Bouaziz, Kavan 2017). `muscle`: share of each tet that is muscle.
std::vector<double> metric_stiffness(const std::vector<TetMaterial>& tets, const std::vector<double>& muscle,
                                     const Materials& materials);

// A positive definite matrix and its inverse, with three right-hand sides at once. A sparse Cholesky factor inverts it;
// in tets of second order a two-grid cycle does so nearly, and reads a tenth as much.
class Metric {
 public:
  using Lanes = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;  // the fourth right side is zero
  struct Scratch {
    Lanes values, sorted;
    GaussSeidel::Lanes right, fine, left;
  };

  explicit Metric(const SparseMatrix& matrix);
  // prolongation: N x C, from the nodes of the coarse grid to all.
  Metric(const SparseMatrix& matrix, const SparseMatrix& prolongation);

  // Replaces `values` (N x 3) by the inverse metric times it. `scratch` is resized as needed. The two-grid cycle is a
  // Gauss-Seidel sweep, the factor of P^T A P on the coarse grid, and a sweep backwards. It is symmetric and positive
  // definite, too (Trottenberg, Oosterlee, Schueller 2001, section 10.3).
  void solve(Positions& values, Scratch& scratch) const;

 private:
  // Replaces the values by the factor's inverse times them; sorted: a place to put them in its order.
  void solve_factor(Lanes& values, Lanes& sorted) const;

  // The factor is kept in single precision: a metric needs no more digits, and reading it is what a solve costs.
  std::vector<int> order_;  // original index of each row of the factor
  FactorPanels<float> panels_;
  std::optional<GaussSeidel> smoother_;                       // with two grids
  Eigen::SparseMatrix<float, Eigen::RowMajor> prolongation_;  // with two grids
};

}  // namespace bodyopt::trainer
