#include "trainer/train/regression/components.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <random>

#include "base/linear_algebra.h"

namespace bodyopt::trainer {
namespace {

// N x 3 region vertices, each vertex scaled by the root of its weight.
Eigen::MatrixXf weighted_columns(const Displacements& displacements, const RegionWeights& region) {
  Eigen::MatrixXf columns(displacements.rows(), 3 * static_cast<Eigen::Index>(region.vertices.size()));
  for (std::size_t v = 0; v < region.vertices.size(); ++v) {
    columns.middleCols(3 * static_cast<Eigen::Index>(v), 3) =
        displacements.middleCols(3 * Eigen::Index{region.vertices[v]}, 3) *
        static_cast<float>(std::sqrt(region.weights[v]));
  }
  return columns;
}

// An orthonormal basis of the columns' span.
Eigen::MatrixXf orthonormal(const Eigen::MatrixXf& matrix) {
  return Eigen::HouseholderQR<Eigen::MatrixXf>(matrix).householderQ() *
         Eigen::MatrixXf::Identity(matrix.rows(), matrix.cols());
}

struct SingularVectors {
  Eigen::VectorXd values;  // descending
  Eigen::MatrixXd left;    // N x K
  Eigen::MatrixXd right;   // K x columns
};

// Randomised subspace iteration (Halko, Martinsson and Tropp 2011, algorithm 4.4).
SingularVectors leading_singular_vectors(const Eigen::MatrixXf& matrix, Eigen::Index count, std::uint64_t seed) {
  constexpr int kIterations = 5;
  constexpr Eigen::Index kExtra = 8;
  const Eigen::Index size = std::min({matrix.rows(), matrix.cols(), count + kExtra});
  std::mt19937_64 random(seed);
  std::normal_distribution<float> normal;
  const auto draw = [&] { return normal(random); };
  Eigen::MatrixXf space = orthonormal(matrix * Eigen::MatrixXf::NullaryExpr(matrix.cols(), size, draw));
  for (int k = 0; k < kIterations; ++k) {
    const Eigen::MatrixXf other = orthonormal(matrix.transpose() * space);
    space = orthonormal(matrix * other);
  }
  const Eigen::MatrixXd projected = (space.transpose() * matrix).cast<double>();  // size x columns
  const Eigen::MatrixXd turn =
      symmetric_eigen(projected * projected.transpose()).vectors.rowwise().reverse().leftCols(std::min(count, size));
  SingularVectors result;
  result.right = turn.transpose() * projected;
  result.values = result.right.rowwise().norm();
  result.left = space.cast<double>() * turn;
  return result;
}

void measure_energies(const Eigen::MatrixXf& columns, Components& components) {
  components.energy = columns.rowwise().squaredNorm().cast<double>();
  const Eigen::VectorXd held = components.coefficients.rowwise().squaredNorm();
  components.truncated = (components.energy - held).cwiseMax(0);
}

// Orthogonal, K x 3 region vertices: the components in weighted displacements.
Eigen::MatrixXd weighted_vectors(const Components& components, const RegionWeights& region) {
  Eigen::MatrixXd vectors = components.basis;
  for (std::size_t v = 0; v < region.vertices.size(); ++v) {
    vectors.middleCols(3 * static_cast<Eigen::Index>(v), 3) /= std::sqrt(region.weights[v]);
  }
  return vectors;
}

}  // namespace

Components principal_components(const Displacements& displacements, const RegionWeights& region, int count,
                                std::uint64_t seed) {
  const Eigen::MatrixXf columns = weighted_columns(displacements, region);
  const SingularVectors singular = leading_singular_vectors(columns, count, seed);
  // Below this the single-precision products hold only noise.
  constexpr double kNoise = 3e-5;
  Eigen::Index kept = 0;
  while (kept < singular.values.size() && singular.values[kept] > kNoise * singular.values[0]) ++kept;

  Components components;
  components.coefficients = singular.left.leftCols(kept) * singular.values.head(kept).asDiagonal();
  measure_energies(columns, components);
  components.basis = singular.values.head(kept).cwiseInverse().asDiagonal() * singular.right.topRows(kept);
  for (std::size_t v = 0; v < region.vertices.size(); ++v) {
    components.basis.middleCols(3 * static_cast<Eigen::Index>(v), 3) *= std::sqrt(region.weights[v]);
  }
  return components;
}

Eigen::VectorXd component_lengths(const Components& components, const RegionWeights& region) {
  return weighted_vectors(components, region).rowwise().norm();
}

Components on_basis_of(const Components& components, const Displacements& displacements, const RegionWeights& region) {
  const Eigen::MatrixXf columns = weighted_columns(displacements, region);
  Eigen::MatrixXd vectors = weighted_vectors(components, region);
  const Eigen::VectorXd lengths = vectors.rowwise().norm();
  vectors.array().colwise() /= lengths.array();
  Components others;
  others.basis = components.basis;
  others.coefficients = columns.cast<double>() * vectors.transpose();
  measure_energies(columns, others);
  others.coefficients.array().rowwise() /= lengths.transpose().array();
  return others;
}

}  // namespace bodyopt::trainer
