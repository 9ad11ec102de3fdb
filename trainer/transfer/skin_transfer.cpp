#include "trainer/transfer/skin_transfer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/extent.h"
#include "geometry/laplacian.h"
#include "geometry/table_rows.h"

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

// Vertices of the same number are the same points, however unlike they look.
std::vector<int> unsure_vertices(const Correspondence& correspondence) {
  if (correspondence.same_topology) return {};
  return rows_below(correspondence.confidence, kSureConfidence);
}

}  // namespace

HatGradients hat_gradients(const Positions& vertices, const Triangles& triangles, Eigen::Index triangle) {
  const auto corner = [&](int k) -> Eigen::Vector3d { return vertices.row(triangles(triangle, k)); };
  const Eigen::Vector3d along = corner(1) - corner(0), across = corner(2) - corner(0);
  const Eigen::Vector3d twice = along.cross(across);
  const double area2 = twice.norm();
  HatGradients result;
  if (!(area2 > 1e-10 * std::max(along.squaredNorm(), across.squaredNorm()))) return result;
  result.normal = twice / area2;
  result.area = 0.5 * area2;
  for (int k = 0; k < 3; ++k) {
    result.of_corner.col(k) = result.normal.cross(corner((k + 2) % 3) - corner((k + 1) % 3)) / area2;
  }
  return result;
}

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

SkinTransfer::SkinTransfer(const Basis& source, const Basis& target, const Correspondence& correspondence,
                           TransferSize size)
    : correspondence_(correspondence),
      transfer_(rows_of(source.mesh.rest), correspondence.fitted, rows_of(source.mesh.triangles), size),
      fill_(correspondence.target, rows_of(target.mesh.triangles), unsure_vertices(correspondence)) {}

Positions SkinTransfer::operator()(const Positions& displacements) const {
  const Positions fitted = transfer_(displacements);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(correspondence_.target.rows(), 3);
  for (Eigen::Index v = 0; v < result.rows(); ++v) {
    const SkinPoint& at = correspondence_.at[static_cast<std::size_t>(v)];
    for (int k = 0; k < 3; ++k) {
      if (at.weights[k] != 0) result.row(v) += at.weights[k] * fitted.row(at.vertices[static_cast<std::size_t>(k)]);
    }
  }
  for (const int v : fill_.unknown()) result.row(v).setZero();  // a piece without a sure vertex does not move
  fill_(result);
  for (Eigen::Index v = 0; v < result.rows(); ++v) {
    const Quat& turn = correspondence_.rotation[static_cast<std::size_t>(v)];
    if (turn == Quat{0, 0, 0, 1}) continue;
    const Vec3 back = rotate(conjugate(turn), {result(v, 0), result(v, 1), result(v, 2)});
    result.row(v) << back[0], back[1], back[2];
  }
  return result;
}

}  // namespace bodyopt
