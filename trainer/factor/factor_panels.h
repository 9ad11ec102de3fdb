// A sparse Cholesky factor as dense panels of neighbouring columns, solved with several right sides in lanes.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

namespace bodyopt::trainer {

// Columns that have the same rows below their own triangle, or nearly: where one lacks a row, a zero stands there.
struct FactorPanel {
  int first, width;         // of its columns; at most FactorPanels::kWidest
  int row_begin, row_end;   // in FactorPanels::rows
  std::size_t first_value;  // in FactorPanels::values: its triangle without the diagonal, then its rows, each by rows
};

// Number: what its values are kept as.
template <typename Number>
struct FactorPanels {
  static constexpr int kWidest = 8;

  std::vector<FactorPanel> panels;  // ascending
  std::vector<int> rows;            // ascending in each panel
  std::vector<Number> values;
  std::vector<double> inverse_diagonal;
};

// lower: L with its diagonal, N x N, as Cholesky factorisation leaves it.
template <typename Number>
FactorPanels<Number> factor_panels(const Eigen::SparseMatrix<double>& lower);

// Replace N x 4 numbers, row by row, by L^-1 times and L^-T times them. The same bits with any instructions.
void solve_forward(const FactorPanels<float>& factor, double* values);
void solve_backward(const FactorPanels<float>& factor, double* values);

// Replaces N x 10 numbers by (L L^T)^-1 times them in the rows of some panels, ascending. No other row is read or
// written, because each panel comes with its parent in the elimination tree, which has its first row below. Where all
// other rows were zero, the results are those of the whole factor.
void solve_ten_in(const FactorPanels<double>& factor, const std::vector<int>& panels, double* values);

}  // namespace bodyopt::trainer
