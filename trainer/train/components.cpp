#include "trainer/train/components.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <random>

namespace bodyopt {
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

// Tiles of single-precision products, summed in double precision.
Eigen::MatrixXd gram(const Eigen::MatrixXf& columns) {
  constexpr Eigen::Index kTile = 1024;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(columns.rows(), columns.rows());
  for (Eigen::Index begin = 0; begin < columns.cols(); begin += kTile) {
    const auto tile = columns.middleCols(begin, std::min(kTile, columns.cols() - begin));
    const Eigen::MatrixXf product = tile * tile.transpose();
    sum += product.cast<double>();
  }
  return sum;
}

Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& matrix) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(matrix).householderQ() *
         Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols());
}

struct Spectrum {
  Eigen::VectorXd values;   // descending
  Eigen::MatrixXd vectors;  // one column each
};

Spectrum leading_eigenvectors(const Eigen::MatrixXd& matrix, Eigen::Index count) {
  constexpr int kIterations = 12;
  constexpr Eigen::Index kExtra = 8;
  const Eigen::Index size = std::min(matrix.rows(), count + kExtra);
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd space = Eigen::MatrixXd::NullaryExpr(matrix.rows(), size, [&] { return normal(random); });
  space = orthonormal(space);
  for (int k = 0; k < kIterations; ++k) space = orthonormal(matrix * space);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(space.transpose() * matrix * space);
  const Eigen::Index kept = std::min(count, size);
  return {solver.eigenvalues().reverse().head(kept), space * solver.eigenvectors().rowwise().reverse().leftCols(kept)};
}

}  // namespace

Components principal_components(const Displacements& displacements, const RegionWeights& region, int count) {
  const Eigen::MatrixXf columns = weighted_columns(displacements, region);
  const Spectrum spectrum = leading_eigenvectors(gram(columns), count);
  // Below this the single-precision products hold only noise.
  constexpr double kNoise = 1e-9;
  Eigen::Index kept = 0;
  while (kept < spectrum.values.size() && spectrum.values[kept] > kNoise * spectrum.values[0]) ++kept;

  Components components;
  components.coefficients.resize(displacements.rows(), kept);
  for (Eigen::Index k = 0; k < kept; ++k) {
    components.coefficients.col(k) = std::sqrt(spectrum.values[k]) * spectrum.vectors.col(k);
  }
  components.basis = spectrum.vectors.leftCols(kept).transpose() * columns.cast<double>();
  for (Eigen::Index k = 0; k < kept; ++k) components.basis.row(k) /= std::sqrt(spectrum.values[k]);
  for (std::size_t v = 0; v < region.vertices.size(); ++v) {
    components.basis.middleCols(3 * static_cast<Eigen::Index>(v), 3) *= std::sqrt(region.weights[v]);
  }
  return components;
}

}  // namespace bodyopt
