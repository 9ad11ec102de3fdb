#include "trainer/train/regression/select_features.h"

#include <algorithm>
#include <cmath>

#include "base/linear_algebra.h"

namespace bodyopt {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kNoise = 1e-3;      // variance, of which a standardised feature has one: less left of it is noise
constexpr double kLeastGain = 1e-5;  // share of the targets' energy
// A feature that has nothing to do with the targets explains, by chance, one part in as many as there are frames of
// what is left of them; the best of some eighty such features about this many times that.
constexpr double kLuck = 4;

constexpr double kRidge = 1e-3;       // times the number of frames
constexpr double kLeastScale = 1e-2;  // of a coordinate, to the first: less is noise

}  // namespace

std::vector<SelectedFeature> select_features(const MatrixXd& features, const MatrixXd& targets, std::size_t limit,
                                             std::span<const Index> deliberate) {
  std::vector<SelectedFeature> selected;
  const double energy = targets.squaredNorm(), frames = static_cast<double>(features.rows());
  if (!(energy > 0)) return selected;
  // What is left of the features' products with each other and with the targets once those selected are taken out: a
  // Cholesky factorisation that chooses its pivots.
  MatrixXd products = features.transpose() * features / frames;
  MatrixXd with_targets = features.transpose() * targets / std::sqrt(frames * energy);
  double unexplained = 1;
  while (selected.size() < limit) {
    const Eigen::VectorXd left = products.diagonal();
    const Eigen::VectorXd gains =
        (left.array() > kNoise).select(with_targets.rowwise().squaredNorm().array() / left.array().max(kNoise), 0.0);
    Eigen::VectorXd least = Eigen::VectorXd::Constant(gains.size(), std::max(kLeastGain, kLuck * unexplained / frames));
    for (const Index column : deliberate) least[column] = kLeastGain;
    Index best = 0;
    if (gains.size() == 0 || !((gains.array() > least.array()).select(gains, 0.0).maxCoeff(&best) > 0)) break;
    selected.push_back({static_cast<std::uint32_t>(best), gains[best]});
    unexplained -= gains[best];
    const double pivot = std::sqrt(left[best]);
    const Eigen::VectorXd column = products.col(best) / pivot;
    const Eigen::RowVectorXd row = with_targets.row(best) / pivot;
    products.noalias() -= column * column.transpose();
    with_targets.noalias() -= column * row;
  }
  return selected;
}

MatrixXd projection(const MatrixXd& features, const MatrixXd& targets) {
  if (features.cols() == 0) return {};
  const double frames = static_cast<double>(features.rows());
  MatrixXd normal = features.transpose() * features;
  normal.diagonal().array() += kRidge * frames;
  const MatrixXd map = Cholesky(normal).solve(features.transpose() * targets);
  // The map's singular values, ascending, are the roots of these; its left singular vectors are their vectors.
  const SymmetricEigen eigen = symmetric_eigen(map * map.transpose());
  const Eigen::VectorXd squares = eigen.values.cwiseMax(0).reverse();
  const Eigen::VectorXd scales = (squares / std::max(squares[0], 1e-300)).cwiseSqrt().cwiseSqrt();
  const Index count = (scales.array() > kLeastScale).count();
  const MatrixXd rows =
      (eigen.vectors.rowwise().reverse().leftCols(count) * scales.head(count).asDiagonal()).transpose();
  return rows.unaryExpr(&stored_half);
}

}  // namespace bodyopt
