// Which features explain what a region does.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "runtime/core/half.h"

namespace bodyopt {

struct SelectedFeature {
  std::uint32_t column;
  double gain;  // the share of the targets' energy that it explains beyond those before it
};

// Columns of `features` (N x F, standardised, less their values at rest) in the order in which each explains most of
// what is left of the targets (N x K) in a linear fit: orthogonal matching pursuit (Pati et al. 1993) for several
// targets. At most `limit`; none that earlier ones tell already, or that explains no more than features that have
// nothing to do with the targets may by chance. Of `deliberate` columns, ascending, somebody made the frames that tell
// of them: chance is no concern.
std::vector<SelectedFeature> select_features(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets,
                                             std::size_t limit, std::span<const Eigen::Index> deliberate = {});

// D x F, every number as the basis stores it: maps features to coordinates, the most telling first. Of a
// ridge-penalised linear map W of the features (N x F, standardised, less their values at rest) to the targets (N x K),
// the left singular vectors, each times the root of its singular value over the largest: distances between coordinates
// then count directions by what follows from them, and damp those of which little does (the metric that gradients of
// the learned map give: Radhakrishnan, Beaglehole, Pandit and Belkin 2024, for a linear map and a gentler power). D is
// at most K; 0 where there are no features.
Eigen::MatrixXd projection(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets);

// A number as the basis stores it: a half that is normal or 0, so that what is fitted is fitted to what will run.
inline double stored_half(double value) {
  const double largest{float_from_half(kLargestHalf)}, smallest{float_from_half(kSmallestNormalHalf)};
  const float clamped = static_cast<float>(std::clamp(value, -largest, largest));
  const double rounded{float_from_half(half_from_float(clamped))};
  return std::abs(rounded) < smallest ? 0 : rounded;
}

}  // namespace bodyopt
