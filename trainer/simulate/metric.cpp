#include "trainer/simulate/metric.h"

#include <Eigen/LU>
#include <Eigen/SparseCholesky>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

// Share of lambda that counts: the volume term is stiff in one direction of nine only. Larger values make shorter,
// safer steps; 0.6 needed the fewest iterations of 0.1, 0.25 and 0.6.
constexpr double kVolumeShare = 0.6;
// Part of the fully active stiffness that counts in muscles.
constexpr double kActiveShare = 0.2;

}  // namespace

SparseMatrix tet_laplacian(const TetMesh& mesh, const std::vector<double>& coefficients) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(16 * static_cast<std::size_t>(mesh.tets.rows()));
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    const Eigen::Matrix3d edges = tet_edges(mesh, t);
    Eigen::Matrix<double, 4, 3> slopes;
    slopes.bottomRows<3>() = edges.inverse();
    slopes.row(0) = -slopes.bottomRows<3>().colwise().sum();
    const double weight = coefficients[static_cast<std::size_t>(t)] * edges.determinant() / 6;
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        entries.emplace_back(mesh.tets(t, a), mesh.tets(t, b), weight * slopes.row(a).dot(slopes.row(b)));
      }
    }
  }
  SparseMatrix matrix(mesh.nodes.rows(), mesh.nodes.rows());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
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
  const SparseMatrix lower = factor.matrixL();
  const auto& original = factor.permutationPinv().indices();
  order_.assign(original.data(), original.data() + original.size());
  column_begin_.push_back(0);
  for (int column = 0; column < lower.cols(); ++column) {
    for (SparseMatrix::InnerIterator it(lower, column); it; ++it) {
      if (it.row() == column) {
        inverse_diagonal_.push_back(1 / it.value());
      } else {
        entries_.push_back({static_cast<int>(it.row()), static_cast<float>(it.value())});
      }
    }
    column_begin_.push_back(entries_.size());
  }
}

void Metric::solve(Positions& values, Positions& scratch) const {
  const std::size_t count = order_.size();
  scratch.resize(values.rows(), 3);
  for (std::size_t k = 0; k < count; ++k) {
    scratch.row(static_cast<Eigen::Index>(k)) = values.row(order_[k]);
  }
  double* x = scratch.data();
  for (std::size_t column = 0; column < count; ++column) {
    double* own = x + 3 * column;
    for (int i = 0; i < 3; ++i) own[i] *= inverse_diagonal_[column];
    const double a = own[0], b = own[1], c = own[2];
    for (std::size_t e = column_begin_[column]; e < column_begin_[column + 1]; ++e) {
      double* other = x + 3 * static_cast<std::size_t>(entries_[e].row);
      const double value = double{entries_[e].value};
      other[0] -= value * a;
      other[1] -= value * b;
      other[2] -= value * c;
    }
  }
  for (std::size_t column = count; column-- > 0;) {
    double* own = x + 3 * column;
    double a = own[0], b = own[1], c = own[2];
    for (std::size_t e = column_begin_[column]; e < column_begin_[column + 1]; ++e) {
      const double* other = x + 3 * static_cast<std::size_t>(entries_[e].row);
      const double value = double{entries_[e].value};
      a -= value * other[0];
      b -= value * other[1];
      c -= value * other[2];
    }
    own[0] = a * inverse_diagonal_[column];
    own[1] = b * inverse_diagonal_[column];
    own[2] = c * inverse_diagonal_[column];
  }
  for (std::size_t k = 0; k < count; ++k) {
    values.row(order_[k]) = scratch.row(static_cast<Eigen::Index>(k));
  }
}

}  // namespace bodyopt
