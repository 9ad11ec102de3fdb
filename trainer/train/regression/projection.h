// The few directions among a region's features that its motion answers to.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "runtime/core/half.h"

namespace bodyopt {

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
