#include "trainer/transfer/smooth_fill.h"

#include "geometry/laplacian.h"

namespace bodyopt {

SmoothFill::SmoothFill(const Positions& skin, const Triangles& triangles, std::vector<int> unknown)
    : unknown_(std::move(unknown)) {
  if (unknown_.empty()) return;
  std::vector<int> place(static_cast<std::size_t>(skin.rows()), -1);
  for (std::size_t k = 0; k < unknown_.size(); ++k) place[static_cast<std::size_t>(unknown_[k])] = static_cast<int>(k);
  const Eigen::VectorXd areas = lumped_areas(skin, triangles);
  anchors_ = 1e-6 / areas.mean() * areas(unknown_);
  const Eigen::SparseMatrix<double> membrane = cotangent_laplacian(skin, triangles);
  std::vector<Eigen::Triplet<double>> among, across;
  for (int column = 0; column < membrane.outerSize(); ++column) {
    const int to = place[static_cast<std::size_t>(column)];
    for (Eigen::SparseMatrix<double>::InnerIterator entry(membrane, column); entry; ++entry) {
      const int from = place[static_cast<std::size_t>(entry.row())];
      if (from < 0) continue;
      if (to < 0) {
        across.emplace_back(from, column, -entry.value());
      } else {
        among.emplace_back(from, to, entry.value());
      }
    }
  }
  for (int k = 0; k < static_cast<int>(unknown_.size()); ++k) among.emplace_back(k, k, anchors_[k]);
  const auto count = static_cast<Eigen::Index>(unknown_.size());
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(among.begin(), among.end());
  from_known_.resize(count, skin.rows());
  from_known_.setFromTriplets(across.begin(), across.end());
  solver_ = SparseSolver(matrix);
}

void SmoothFill::operator()(Eigen::MatrixXd& values) const {
  if (unknown_.empty()) return;
  const Eigen::MatrixXd right =
      from_known_ * values + anchors_.asDiagonal() * Eigen::MatrixXd(values(unknown_, Eigen::all));
  const Eigen::MatrixXd filled = solver_.solve(right);
  values(unknown_, Eigen::all) = filled;
}

std::vector<int> rows_below(const Eigen::VectorXd& values, double least) {
  std::vector<int> rows;
  for (int v = 0; v < static_cast<int>(values.size()); ++v) {
    if (values[v] < least) rows.push_back(v);
  }
  return rows;
}

}  // namespace bodyopt
