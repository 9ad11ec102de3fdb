#include "bench/randomised_svd.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <random>

namespace bodyopt::bench {
namespace {

using Eigen::MatrixXf;

MatrixXf gaussian(Eigen::Index rows, Eigen::Index columns, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  return MatrixXf::NullaryExpr(rows, columns, [&] { return normal(random); });
}

// A = QR with as many columns in Q as in A.
struct ThinQr {
  explicit ThinQr(const MatrixXf& a) : factors(a), q(factors.householderQ() * MatrixXf::Identity(a.rows(), a.cols())) {}
  MatrixXf r() const { return factors.matrixQR().topRows(q.cols()).triangularView<Eigen::Upper>(); }
  Eigen::HouseholderQR<MatrixXf> factors;
  MatrixXf q;
};

}  // namespace

Svd randomised_svd(const RowMajorMatrix& matrix, Eigen::Index rank, std::uint32_t seed) {
  constexpr Eigen::Index kMore = 10;
  const Eigen::Index tried = std::min({rank + kMore, matrix.rows(), matrix.cols()});
  MatrixXf range = ThinQr(matrix * gaussian(matrix.cols(), tried, seed)).q;
  range = ThinQr(matrix.transpose() * range).q;
  range = ThinQr(matrix * range).q;
  const ThinQr projected(matrix.transpose() * range);  // (Q* A)*, long and thin: its SVD is that of R
  const Eigen::BDCSVD<MatrixXf> small(projected.r().transpose(), Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::Index kept = std::min(rank, tried);
  return {range * small.matrixU().leftCols(kept), small.singularValues().head(kept),
          projected.q * small.matrixV().leftCols(kept)};
}

}  // namespace bodyopt::bench
