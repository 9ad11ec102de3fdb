#include "trainer/train/regression/select_features.h"

#include <algorithm>
#include <cmath>

namespace bodyopt {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kNoise = 1e-3;      // variance, of which a standardised feature has one: less left of it is noise
constexpr double kLeastGain = 1e-5;  // share of the targets' energy
// A feature that has nothing to do with the targets explains, by chance, one part in as many as there are frames of
// what is left of them; the best of some eighty such features about this many times that.
constexpr double kLuck = 4;

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

}  // namespace bodyopt
