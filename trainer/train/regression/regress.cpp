#include "trainer/train/regression/regress.h"

#include <limits>
#include <map>
#include <optional>
#include <stdexcept>

#include "base/linear_algebra.h"
#include "base/quantile.h"
#include "base/rows_where.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kNoise = 1e-3;      // variance, of which a standardised feature has one: less left of it is noise
constexpr double kLeastGain = 1e-5;  // share of the targets' energy
// A feature that has nothing to do with the targets explains by chance what is left of them, divided by the number of
// frames. The best of some eighty such features explains about this many times that.
constexpr double kLuck = 4;

constexpr double kRidge = 1e-3;       // times the number of frames
constexpr double kLeastScale = 1e-2;  // of a coordinate, to the first: less is noise

// Multiples of the median distance between centres, and the penalties tried.
constexpr double kWidths[] = {1, 2, 4, 0.5};
constexpr double kLinearPenalties[] = {1e-4, 1e-3, 1e-2, 1e-1, 1};
constexpr double kKernelPenalties[] = {1e-5, 1e-4, 1e-3, 1e-2, 1e-1};

// Farthest-point sampling, starting with the rest pose. Distances are those of the frames as they are, so that none is
// chosen twice. A regression of these centres and nothing else yet.
Regression choose_centres(const RegressionData& data, int count) {
  const Index most = std::min<Index>(count, data.features.rows() + 1);
  MatrixXd points(most, data.features.cols());
  std::vector<int> frames;
  Eigen::VectorXd nearest = (data.features.rowwise() - data.rest).rowwise().squaredNorm();
  for (Index m = 0; m < most; ++m) {
    Index farthest = -1;
    if (m > 0 && !(nearest.maxCoeff(&farthest) > 1e-6)) break;
    points.row(m) = m == 0 ? data.rest : Eigen::RowVectorXd(data.features.row(farthest));
    frames.push_back(static_cast<int>(farthest));
    nearest = nearest.cwiseMin((data.features.rowwise() - points.row(m)).rowwise().squaredNorm());
  }
  Regression regression;
  regression.centres = points.topRows(static_cast<Index>(frames.size())).unaryExpr(&stored_half);
  regression.centre_frames = std::move(frames);
  return regression;
}

double median_distance(const MatrixXd& centres) {
  std::vector<double> distances;
  const MatrixXd squared = squared_distances(centres, centres);
  for (Index a = 0; a < centres.rows(); ++a) {
    for (Index b = 0; b < a; ++b) distances.push_back(std::sqrt(squared(a, b)));
  }
  return distances.empty() ? 1 : median(distances);
}

// N. A frame that counts for nothing counts for a millionth, so that its error is known.
Eigen::VectorXd frame_weights(const RegressionData& data) {
  if (data.weights.size() == 0) return Eigen::VectorXd::Ones(data.features.rows());
  return data.weights.cwiseMax(1e-6);
}

// The fits that features, centres and width leave open: normal equations gathered once for all penalties.
class KernelRidge {
 public:
  KernelRidge(const RegressionData& data, const MatrixXd& centres, double inverse_width2)
      : inverse_width2_(inverse_width2), kernel_norm_(kernels(centres, centres)) {
    // The weights multiply these, less their values at rest.
    MatrixXd regressors(data.features.rows(), data.features.cols() + centres.rows());
    regressors << data.features.rowwise() - data.rest,
        kernels(data.features, centres).rowwise() - kernels(data.rest, centres).row(0);
    // A frame that counts twice is a row times the root of two.
    scales_ = frame_weights(data).cwiseSqrt();
    regressors.array().colwise() *= scales_.array();
    const int last = *std::max_element(data.folds.begin(), data.folds.end());
    for (int fold = -1; fold <= last; ++fold) {
      const std::vector<Index> rows = rows_where(data.folds, [&](int of) { return of == fold; });
      Fold& part = fold < 0 ? guards_ : folds_.emplace_back();
      part.rows = rows;
      part.regressors = regressors(rows, Eigen::all);
      part.targets = data.targets(rows, Eigen::all);
      part.targets.array().colwise() *= scales_(rows).array();
      part.frames = scales_(rows).squaredNorm();
      part.normal = MatrixXd::Zero(regressors.cols(), regressors.cols());
      if (part.regressors.size() > 0) {  // Eigen refers to the first number, also where there is none
        part.normal.selfadjointView<Eigen::Lower>().rankUpdate(part.regressors.transpose());
      }
      part.right = part.regressors.transpose() * part.targets;
    }
  }

  double inverse_width2() const { return inverse_width2_; }

  // Root mean square of what each fold's frames differ from the fit of the others.
  double validation_error(const Penalty& penalty) const {
    double sum = 0, frames = 0;
    for (std::size_t fold = 0; fold < folds_.size(); ++fold) {
      sum += fold_error(fold, penalty);
      frames += folds_[fold].frames;
    }
    return std::sqrt(sum / frames);
  }

  // Sum of the squares of what one fold's frames differ from the fit of the others.
  double fold_error(std::size_t fold, const Penalty& penalty) const {
    const Fold& held_out = folds_[fold];
    return (held_out.regressors * solve(sums_without(&held_out), penalty) - held_out.targets).squaredNorm();
  }

  // N x K: what each fold's frames differ from the fit of the others, 0 for frames of no fold.
  MatrixXd errors(const Penalty& penalty) const {
    Index frames = static_cast<Index>(guards_.rows.size());
    for (const Fold& fold : folds_) frames += static_cast<Index>(fold.rows.size());
    MatrixXd errors = MatrixXd::Zero(frames, guards_.right.cols());
    for (const Fold& held_out : folds_) {
      errors(held_out.rows, Eigen::all) =
          held_out.regressors * solve(sums_without(&held_out), penalty) - held_out.targets;
    }
    errors.array().colwise() /= scales_.array();
    return errors;
  }

  // Fitted to all frames.
  MatrixXd weights(const Penalty& penalty) const {
    Sums sums = sums_without(nullptr);
    sums.add(guards_);
    return solve(std::move(sums), penalty);
  }

 private:
  struct Fold {
    std::vector<Index> rows;
    MatrixXd regressors, targets, right;
    MatrixXd normal;    // its lower triangle
    double frames = 0;  // as they count
  };
  struct Sums {
    MatrixXd normal, right;
    double frames = 0;
    void add(const Fold& fold) {
      normal += fold.normal;
      right += fold.right;
      frames += fold.frames;
    }
  };

  // The number of rows is even, since Eigen leaves the last of an odd number of elements to the C library. Its exp has
  // other last bits on processors without FMA.
  MatrixXd kernels(const MatrixXd& points, const MatrixXd& centres) const {
    const Index rows = points.rows();
    MatrixXd values = MatrixXd::Zero(rows + rows % 2, centres.rows());
    values.topRows(rows) = squared_distances(points, centres) * -inverse_width2_;
    values = values.array().exp();
    return values.topRows(rows);
  }

  Sums sums_without(const Fold* held_out) const {
    Sums sums{MatrixXd::Zero(guards_.normal.rows(), guards_.normal.cols()),
              MatrixXd::Zero(guards_.right.rows(), guards_.right.cols())};
    for (const Fold& fold : folds_) {
      if (&fold != held_out) sums.add(fold);
    }
    return sums;
  }

  MatrixXd solve(Sums sums, const Penalty& penalty) const {
    if (sums.normal.size() == 0) return sums.right;  // no feature varies: no weights
    const Index kernels = kernel_norm_.rows(), linear = sums.normal.rows() - kernels;
    sums.normal.diagonal().head(linear).array() += penalty.linear * sums.frames;
    sums.normal.bottomRightCorner(kernels, kernels) += penalty.kernel * kernel_norm_;
    // The ridge is as little as the factorisation needs: kernels far wider than their distances are nearly the same.
    const Eigen::VectorXd diagonal = sums.normal.diagonal();
    for (double ridge = 1e-10 * std::max(1.0, sums.normal.trace());; ridge *= 100) {
      sums.normal.diagonal() = diagonal.array() + ridge;
      const Cholesky factor(sums.normal);
      if (factor.is_positive()) return factor.solve(sums.right);
      if (!std::isfinite(ridge)) throw std::logic_error("normal equations that no ridge makes definite");
    }
  }

  double inverse_width2_;
  MatrixXd kernel_norm_;    // the kernels' inner products
  Eigen::VectorXd scales_;  // N: of every frame's row
  Fold guards_;             // frames of no fold
  std::vector<Fold> folds_;
};

double inverse_width2(double width, double median) { return 0.5 / std::pow(width * median, 2); }

KernelRidge middling_ridge(const RegressionData& data, int centre_count) {
  const MatrixXd centres = choose_centres(data, centre_count).centres;
  return {data, centres, inverse_width2(kWidths[1], median_distance(centres))};
}

void finish(const KernelRidge& ridge, const Penalty& penalty, Regression& regression) {
  regression.inverse_width2 = ridge.inverse_width2();
  regression.penalty = penalty;
  regression.weights = ridge.weights(penalty);
  regression.errors = ridge.errors(penalty);
}

}  // namespace

std::vector<SelectedFeature> select_features(const MatrixXd& features, const MatrixXd& targets, std::size_t limit,
                                             std::span<const Index> deliberate) {
  std::vector<SelectedFeature> selected;
  const double energy = targets.squaredNorm(), frames = static_cast<double>(features.rows());
  if (!(energy > 0)) return selected;
  // The features' products with each other and with the targets, with those selected taken out: a Cholesky
  // factorisation that chooses its pivots.
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

MatrixXd squared_distances(const MatrixXd& a, const MatrixXd& b) {
  MatrixXd distances = -2 * a * b.transpose();
  distances.colwise() += a.rowwise().squaredNorm();
  distances.rowwise() += b.rowwise().squaredNorm().transpose();
  return distances.cwiseMax(0);
}

double trial_error(const RegressionData& data, int centre_count) {
  return middling_ridge(data, centre_count).validation_error({});
}

double fold_error(const RegressionData& data, int centre_count, int fold) {
  return middling_ridge(data, centre_count).fold_error(static_cast<std::size_t>(fold), {});
}

// One hyper-parameter after the other: all combinations would be four times as many fits.
Regression fit_regression(const RegressionData& data, int centre_count) {
  Regression best = choose_centres(data, centre_count);
  best.validation_error = std::numeric_limits<double>::infinity();
  const bool has_kernels = best.centres.rows() > 0;
  const double median = median_distance(best.centres);
  std::optional<KernelRidge> ridge;
  for (const double width : kWidths) {
    KernelRidge candidate(data, best.centres, inverse_width2(width, median));
    const double error = candidate.validation_error({});
    if (!ridge || !(error >= best.validation_error)) {
      best.validation_error = error;
      ridge = std::move(candidate);
    }
    if (!has_kernels) break;
  }
  Penalty penalty;
  const auto consider = [&](const Penalty& candidate) {
    const double error = ridge->validation_error(candidate);
    if (!(error < best.validation_error)) return;
    best.validation_error = error;
    penalty = candidate;
  };
  if (has_kernels) {
    for (const double kernel : kKernelPenalties) consider({penalty.linear, kernel});
  }
  for (const double linear : kLinearPenalties) consider({linear, penalty.kernel});
  finish(*ridge, penalty, best);
  return best;
}

Regression refit_regression(const RegressionData& data, int centre_count, const Regression& earlier) {
  Regression regression = choose_centres(data, centre_count);
  const KernelRidge ridge(data, regression.centres, earlier.inverse_width2);
  finish(ridge, earlier.penalty, regression);
  const Eigen::VectorXd weights = frame_weights(data);
  double heldout = 0;
  for (std::size_t n = 0; n < data.folds.size(); ++n) heldout += data.folds[n] < 0 ? 0 : weights[static_cast<Index>(n)];
  const double squares = regression.errors.rowwise().squaredNorm().dot(weights);
  regression.validation_error = std::sqrt(squares / heldout);
  return regression;
}

std::vector<int> blocked_folds(const std::vector<int>& takes, int longest_run, int count) {
  std::map<int, int> frames_of;
  for (const int take : takes) ++frames_of[take];
  std::vector<int> folds;
  int position = 0, block = 0, run = 0;
  for (std::size_t n = 0; n < takes.size(); ++n) {
    const bool new_take = n == 0 || takes[n] != takes[n - 1];
    if (new_take) run = std::clamp(frames_of[takes[n]] / (2 * count), 2, longest_run);
    if (n > 0 && (new_take || position == run)) {
      ++block;
      position = 0;
    }
    const bool guard = position == run - 1;
    folds.push_back(guard ? -1 : block % count);
    ++position;
  }
  return folds;
}

}  // namespace bodyopt::trainer
