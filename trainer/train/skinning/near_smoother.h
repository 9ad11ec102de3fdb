// Smoothing of what is zero on most of a skin.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "trainer/factor/factor_panels.h"

namespace bodyopt::trainer {

// Ten numbers at some vertices, zero at all others.
struct TenColumns {
  std::vector<int> vertices;  // each once
  Eigen::Matrix<double, Eigen::Dynamic, 10, Eigen::RowMajor> values;
};

// Implicit steps of diffusion over a skin, ((A + L)^-1 A)^steps, factorised once. Numbers are carried as far as they
// keep 1e-8 of their size, and only there is anything solved. A step solves with the whole skin's factor, then what it
// put further away is left out.
class NearSmoother {
 public:
  // areas: the diagonal A, V. laplacian: L, V x V, which has no positive entry beside its diagonal.
  NearSmoother(Eigen::VectorXd areas, const Eigen::SparseMatrix<double>& laplacian, int steps);

  bool is_solvable() const { return is_solvable_; }
  // May be called on any thread.
  TenColumns operator()(const TenColumns& from) const;

 private:
  std::vector<int> around(const std::vector<int>& vertices) const;
  // The panels of some vertices, and those that these depend on.
  std::vector<int> panels_of(const std::vector<int>& vertices) const;

  Eigen::VectorXd areas_;
  int steps_;
  bool is_solvable_;
  Eigen::SparseMatrix<double> lengths_;  // of edges, in decay lengths of one step
  std::vector<int> row_;                 // of the factor, V
  FactorPanels<double> factor_;
  std::vector<int> panel_;  // of each row of the factor, V
};

}  // namespace bodyopt::trainer
