// Regression from features to coefficients: a ridge-penalised linear part and Gaussian kernels at chosen centres,
// fitted together. It is kernel ridge regression with a linear part, by subset of regressors (Rasmussen & Williams
// 2006, 8.3).
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "runtime/core/half.h"

namespace bodyopt::trainer {

// Features that explain what a region does.

struct SelectedFeature {
  std::uint32_t column;
  double gain;  // the share of the targets' energy that it explains beyond those before it
};

// Columns of `features` (N x F, standardised, less values at rest), `limit` at most, by orthogonal matching pursuit
// (Pati et al. 1993) for several targets. Each explains most of what those before it leave of the targets (N x K) in a
// linear fit. None follows from earlier ones, or explains no more than features that have nothing to do with the
// targets may by chance. Of `deliberate` columns, ascending, somebody made the frames that tell of them: chance is no
// concern.
std::vector<SelectedFeature> select_features(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets,
                                             std::size_t limit, std::span<const Eigen::Index> deliberate = {});

// D x F, every number as the basis stores it: maps features to coordinates, the most telling first. Let W be a
// ridge-penalised linear map of the features (N x F, standardised, less their values at rest) to the targets (N x K).
// The rows are W's left singular vectors, each times the root of its singular value over the largest. Distances between
// coordinates then count directions by what follows from them, and damp those of which little does. Gradients of the
// learned map give this metric (Radhakrishnan, Beaglehole, Pandit and Belkin 2024), here for a linear map and a gentler
// power. D is at most K; 0 where there are no features.
Eigen::MatrixXd projection(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets);

// A number as the basis stores it: a half that is normal or 0, so that what is fitted is fitted to what will run.
inline double stored_half(double value) {
  const double largest{float_from_half(kLargestHalf)}, smallest{float_from_half(kSmallestNormalHalf)};
  const float clamped = static_cast<float>(std::clamp(value, -largest, largest));
  const double rounded{float_from_half(half_from_float(clamped))};
  return std::abs(rounded) < smallest ? 0 : rounded;
}

struct RegressionData {
  Eigen::MatrixXd features;   // N x F, of like scales: a region's coordinates
  Eigen::RowVectorXd rest;    // F: the features at rest, where the answer is zero
  Eigen::MatrixXd targets;    // N x K
  Eigen::VectorXd weights{};  // N: how many times each frame counts, 0 or more; empty: each once
  std::vector<int> folds;     // N: the cross-validation fold that holds each frame out, -1: used by none for fitting
};

// Ridges on the linear weights (times the number of frames) and on the kernels' norm.
struct Penalty {
  double linear = 1e-2, kernel = 1e-4;
};

struct Regression {
  Eigen::MatrixXd centres;  // M x F, every value a half that is normal or 0
  double inverse_width2 = 0;
  Penalty penalty;
  Eigen::MatrixXd weights;         // (F + M) x K, of [f, phi(f)]; no constant: what holds at rest is subtracted anyway
  std::vector<int> centre_frames;  // M: the frame of each centre, -1 for the rest pose
  Eigen::MatrixXd errors;          // N x K: of each frame as the fit of the other folds has it, 0 for guard frames
  double validation_error = 0;     // root mean square of the held-out folds' error, summed over the targets
};

// A x B: between the rows of `a` and those of `b`.
Eigen::MatrixXd squared_distances(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// Chooses width and penalties by cross-validation over the folds, then fits all frames. At most `centre_count` centres:
// the rest pose, then the training frames furthest from those chosen before, rounded. Deterministic.
Regression fit_regression(const RegressionData& data, int centre_count);

// Fits with the width and the penalties of an earlier fit.
Regression refit_regression(const RegressionData& data, int centre_count, const Regression& earlier);

// Root mean square that cross-validation leaves with middling width and penalties, summed over the targets. It serves
// to choose between features at a tenth of the price of a fit.
double trial_error(const RegressionData& data, int centre_count);

// The sum of all squared errors, with the same, of the frames of one fold as the other folds' fit has them.
double fold_error(const RegressionData& data, int centre_count, int fold);

// Folds for frames given in time order: runs of consecutive frames of a take go to one fold of `count`. The last frame
// of every run goes to none (-1), so that neighbours never stand on both sides. A run is so long that every fold has
// two of every take, `longest_run` at most and two frames at least. What is held out is motion that the rest of its
// take surrounds, not a take of its own.
std::vector<int> blocked_folds(const std::vector<int>& takes, int longest_run, int count);

}  // namespace bodyopt::trainer
