#include "trainer/transfer/skin_transfer.h"

#include "geometry/laplacian.h"
#include "trainer/transfer/table_rows.h"

namespace bodyopt {

SkinTransfer::SkinTransfer(const Basis& source, const Basis& target, const Correspondence& correspondence,
                           TransferSize size)
    : correspondence_(correspondence),
      transfer_(rows_of(source.mesh.rest), correspondence.fitted, rows_of(source.mesh.triangles), size) {
  if (!correspondence.same_topology) prepare_filling(rows_of(target.mesh.triangles));
}

void SkinTransfer::prepare_filling(const Triangles& triangles) {
  const Eigen::Index count = correspondence_.target.rows();
  std::vector<int> place(static_cast<std::size_t>(count), -1);
  for (int v = 0; v < static_cast<int>(count); ++v) {
    if (correspondence_.confidence[v] >= kSureConfidence) continue;
    place[static_cast<std::size_t>(v)] = static_cast<int>(unsure_.size());
    unsure_.push_back(v);
  }
  if (unsure_.empty()) return;
  const Eigen::SparseMatrix<double> membrane = cotangent_laplacian(correspondence_.target, triangles);
  const Eigen::VectorXd areas = lumped_areas(correspondence_.target, triangles);
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
  // A piece without a sure vertex does not move.
  for (std::size_t k = 0; k < unsure_.size(); ++k) {
    among.emplace_back(static_cast<int>(k), static_cast<int>(k), 1e-6 * areas[unsure_[k]] / areas.mean());
  }
  const auto size = static_cast<Eigen::Index>(unsure_.size());
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(among.begin(), among.end());
  to_sure_.resize(size, count);
  to_sure_.setFromTriplets(across.begin(), across.end());
  fill_.compute(matrix);
}

void SkinTransfer::fill_unsure(Positions& displacements) const {
  if (unsure_.empty()) return;
  const Eigen::MatrixXd right = to_sure_ * displacements;
  const Eigen::MatrixXd filled = fill_.solve(right);
  for (std::size_t k = 0; k < unsure_.size(); ++k) {
    displacements.row(unsure_[k]) = filled.row(static_cast<Eigen::Index>(k));
  }
}

Positions SkinTransfer::operator()(const Positions& displacements) const {
  const Positions fitted = transfer_(displacements);
  Positions result = Positions::Zero(correspondence_.target.rows(), 3);
  for (Eigen::Index v = 0; v < result.rows(); ++v) {
    const SkinPoint& at = correspondence_.at[static_cast<std::size_t>(v)];
    for (int k = 0; k < 3; ++k) {
      if (at.weights[k] != 0) result.row(v) += at.weights[k] * fitted.row(at.vertices[static_cast<std::size_t>(k)]);
    }
  }
  fill_unsure(result);
  for (Eigen::Index v = 0; v < result.rows(); ++v) {
    const Quat& turn = correspondence_.rotation[static_cast<std::size_t>(v)];
    if (turn == Quat{0, 0, 0, 1}) continue;
    const Vec3 back = rotate(conjugate(turn), {result(v, 0), result(v, 1), result(v, 2)});
    result.row(v) << back[0], back[1], back[2];
  }
  return result;
}

}  // namespace bodyopt
