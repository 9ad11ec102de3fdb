#include "trainer/simulate/metric.h"

#include <Eigen/LU>
#include <Eigen/SparseCholesky>

#include "base/linear_algebra.h"
#include "runtime/core/error.h"

namespace bodyopt::trainer {
namespace {

// Share of lambda that counts: the volume term is stiff in one direction of nine only. Larger values make shorter,
// safer steps; 0.8 needed the fewest iterations of 0.3, 0.45, 0.6, 0.8 and 1.
constexpr double kVolumeShare = 0.8;
// Part of the fully active stiffness that counts in muscles.
constexpr double kActiveShare = 0.05;

}  // namespace

SparseMatrix tet_laplacian(const TetMesh& mesh, const std::vector<double>& coefficients) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(16 * static_cast<std::size_t>(mesh.tets.rows()));
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    const Eigen::Matrix3d edges = tet_edges(mesh, t);
    const Eigen::Matrix<double, 4, 3> slopes = corner_slopes(edges);
    const double weight = coefficients[static_cast<std::size_t>(t)] * edges.determinant() / 6;
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        entries.emplace_back(mesh.tets(t, a), mesh.tets(t, b), weight * slopes.row(a).dot(slopes.row(b)));
      }
    }
  }
  return sparse_matrix(mesh.nodes.rows(), mesh.nodes.rows(), entries);
}

std::vector<double> metric_stiffness(const std::vector<TetMaterial>& tets, const std::vector<double>& muscle,
                                     const Materials& materials) {
  std::vector<double> stiffness;
  for (std::size_t t = 0; t < tets.size(); ++t) {
    const double fibres = muscle[t] * (materials.passive_fibre + kActiveShare * materials.active_fibre);
    stiffness.push_back(tets[t].mu + kVolumeShare * tets[t].lambda + fibres);
  }
  return stiffness;
}

Metric::Metric(const SparseMatrix& matrix) {
  const Eigen::SimplicialLLT<SparseMatrix> factor(matrix);
  if (factor.info() != Eigen::Success) {
    throw Error(ErrorKind::mismatch, "the tetrahedra give no positive definite stiffness: some are flat");
  }
  const auto& original = factor.permutationPinv().indices();
  order_.assign(original.data(), original.data() + original.size());
  panels_ = factor_panels<float>(factor.matrixL());
}

Metric::Metric(const SparseMatrix& matrix, const SparseMatrix& prolongation)
    : Metric(SparseMatrix(prolongation.transpose() * matrix * prolongation)) {
  smoother_.emplace(matrix);
  prolongation_ = prolongation.cast<float>();
}

void Metric::solve_factor(Lanes& values, Lanes& sorted) const {
  sorted.resize(values.rows(), 4);
  for (Eigen::Index k = 0; k < values.rows(); ++k) sorted.row(k) = values.row(order_[static_cast<std::size_t>(k)]);
  solve_forward(panels_, sorted.data());
  solve_backward(panels_, sorted.data());
  for (Eigen::Index k = 0; k < values.rows(); ++k) values.row(order_[static_cast<std::size_t>(k)]) = sorted.row(k);
}

void Metric::solve(Positions& values, Scratch& scratch) const {
  auto& [grid, sorted, right, fine, left] = scratch;
  if (!smoother_) {
    grid.resize(values.rows(), 4);
    grid << values, Eigen::VectorXd::Zero(values.rows());
    solve_factor(grid, sorted);
    values = grid.leftCols<3>();
    return;
  }
  right.resize(values.rows(), 4);
  right << values.cast<float>(), Eigen::VectorXf::Zero(values.rows());
  smoother_->forward(right, fine);
  smoother_->remainder(fine, left);
  grid = (prolongation_.transpose() * left).eval().cast<double>();
  solve_factor(grid, sorted);
  fine += prolongation_ * grid.cast<float>();
  smoother_->backward(right, fine);
  values = fine.leftCols<3>().cast<double>();
}

}  // namespace bodyopt::trainer
