// The few directions among a region's features that its motion answers to.
#pragma once

#include <Eigen/Core>

namespace bodyopt {

// D x F, every number as the basis stores it: maps features to coordinates, the most telling first. Of a
// ridge-penalised linear map W of the features (N x F, standardised, less their values at rest) to the targets (N x K),
// the left singular vectors, each times the root of its singular value over the largest: distances between coordinates
// then count directions by what follows from them, and damp those of which little does (the metric that gradients of
// the learned map give: Radhakrishnan, Beaglehole, Pandit and Belkin 2024, for a linear map and a gentler power). D is
// at most K; 0 where there are no features.
Eigen::MatrixXd projection(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets);

}  // namespace bodyopt
