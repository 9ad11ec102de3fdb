#include "trainer/transfer/deformation_transfer.h"

#include <cmath>

#include "geometry/extent.h"
#include "geometry/laplacian.h"

namespace bodyopt {
namespace {

// Of the extent of the target: how far a gradient's error is summed before the anchors take over. Of 0.05, 0.1, 0.25,
// 0.5, 1 and 3 this left the least between two builds of one human (docs/notes, Transfer).
constexpr double kReach = 0.1;

// Lengths of the target over those of the source, around every vertex, smoothed over a tenth of the reach.
Eigen::VectorXd local_sizes(const Positions& source, const Positions& target, const Triangles& triangles) {
  const Eigen::VectorXd ratios =
      (lumped_areas(target, triangles).array() / lumped_areas(source, triangles).array()).sqrt();
  return smoothed(target, triangles, ratios, 0.1 * kReach * longest_extent(target));
}

Eigen::SparseMatrix<double> stiffness(const std::vector<HatGradients>& gradients, const Triangles& triangles,
                                      Eigen::Index vertices) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(9 * gradients.size());
  for (std::size_t t = 0; t < gradients.size(); ++t) {
    const Eigen::Matrix3d products = gradients[t].area * gradients[t].of_corner.transpose() * gradients[t].of_corner;
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        const auto row = static_cast<Eigen::Index>(t);
        entries.emplace_back(static_cast<int>(triangles(row, i)), static_cast<int>(triangles(row, k)), products(i, k));
      }
    }
  }
  Eigen::SparseMatrix<double> matrix(vertices, vertices);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace

DeformationTransfer::DeformationTransfer(const Positions& source, const Positions& target, const Triangles& triangles,
                                         TransferSize size)
    : triangles_(triangles) {
  const double reach = kReach * longest_extent(target);
  const Eigen::VectorXd sizes = local_sizes(source, target, triangles);
  sizes_ = size == TransferSize::local ? sizes : Eigen::VectorXd::Ones(target.rows());
  anchors_ = lumped_areas(target, triangles) / (reach * reach);
  std::vector<HatGradients> on_target;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    on_target.push_back(hat_gradients(target, triangles, t));
    const double mean = (sizes[triangles(t, 0)] + sizes[triangles(t, 1)] + sizes[triangles(t, 2)]) / 3;
    pairs_.push_back(
        {hat_gradients(source, triangles, t), on_target.back(), size == TransferSize::local ? 1 : 1 / mean});
  }
  Eigen::SparseMatrix<double> matrix = stiffness(on_target, triangles, target.rows());
  matrix.diagonal() += anchors_;
  solver_ = SparseSolver(matrix);
}

Positions DeformationTransfer::operator()(const Positions& displacements) const {
  Eigen::MatrixXd right = (anchors_.array() * sizes_.array()).matrix().asDiagonal() * displacements;
  for (std::size_t t = 0; t < pairs_.size(); ++t) {
    const auto& [source, target, scale] = pairs_[t];
    const auto row = static_cast<Eigen::Index>(t);
    Eigen::Matrix3d corners;  // displacements as columns
    for (int k = 0; k < 3; ++k) corners.col(k) = displacements.row(triangles_(row, k)).transpose();
    if (corners.isZero(0)) continue;
    const Eigen::Matrix3d gradient = corners * source.of_corner.transpose();
    const Eigen::Matrix3d wanted = gradient - gradient.transpose() * source.normal * source.normal.transpose();
    const Eigen::Matrix3d pull = scale * target.area * wanted * target.of_corner;
    for (int k = 0; k < 3; ++k) right.row(triangles_(row, k)) += pull.col(k).transpose();
  }
  return solver_.solve(right);
}

}  // namespace bodyopt
