#include "trainer/train/regress.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace bodyopt {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Multiples of the median distance between centres, and the penalties tried: on the linear weights (times the number of
// frames) and on the kernels' norm.
constexpr double kWidths[] = {1, 2, 4};
constexpr double kLinearPenalties[] = {1e-4, 1e-3, 1e-2, 1e-1};
constexpr double kKernelPenalties[] = {1e-5, 1e-4, 1e-3, 1e-2};

MatrixXd squared_distances(const MatrixXd& a, const MatrixXd& b) {
  MatrixXd distances(a.rows(), b.rows());
  for (Index k = 0; k < b.rows(); ++k) distances.col(k) = (a.rowwise() - b.row(k)).rowwise().squaredNorm();
  return distances;
}

// Farthest-point sampling, starting with the rest pose.
MatrixXd choose_centres(const RegressionData& data, int count) {
  const Index most = std::min<Index>(count, data.features.rows() + 1);
  MatrixXd centres(most, data.features.cols());
  if (most == 0) return centres;
  centres.row(0) = data.rest;
  Eigen::VectorXd nearest = (data.features.rowwise() - data.rest).rowwise().squaredNorm();
  for (Index m = 1; m < most; ++m) {
    Index farthest = 0;
    if (!(nearest.maxCoeff(&farthest) > 1e-6)) return centres.topRows(m);
    centres.row(m) = data.features.row(farthest);
    nearest = nearest.cwiseMin((data.features.rowwise() - centres.row(m)).rowwise().squaredNorm());
  }
  return centres;
}

double median_distance(const MatrixXd& centres) {
  std::vector<double> distances;
  const MatrixXd squared = squared_distances(centres, centres);
  for (Index a = 0; a < centres.rows(); ++a) {
    for (Index b = 0; b < a; ++b) distances.push_back(std::sqrt(squared(a, b)));
  }
  if (distances.empty()) return 1;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

// What the weights multiply, less its value at rest, and the kernels' inner products (their norm).
struct Design {
  MatrixXd regressors;   // N x (F + M)
  MatrixXd kernel_norm;  // M x M
};

Design make_design(const RegressionData& data, const MatrixXd& centres, double inverse_width2) {
  const auto kernels = [&](const MatrixXd& points) -> MatrixXd {
    return (squared_distances(points, centres) * -inverse_width2).array().exp();
  };
  Design design;
  design.regressors.resize(data.features.rows(), data.features.cols() + centres.rows());
  design.regressors << data.features.rowwise() - data.rest,
      kernels(data.features).rowwise() - kernels(data.rest).row(0);
  design.kernel_norm = kernels(centres);
  return design;
}

struct Penalty {
  double linear = kLinearPenalties[2], kernel = kKernelPenalties[1];
};

// Weights from normal equations gathered over `frames` frames.
MatrixXd solve(const Design& design, MatrixXd normal, const MatrixXd& right, const Penalty& penalty, double frames) {
  const Index kernels = design.kernel_norm.rows(), linear = normal.rows() - kernels;
  normal.diagonal().head(linear).array() += penalty.linear * frames;
  normal.bottomRightCorner(kernels, kernels) += penalty.kernel * design.kernel_norm;
  normal.diagonal().array() += 1e-10 * std::max(1.0, normal.trace());
  return normal.llt().solve(right);
}

// The normal equations of every fold and of all folds together: the work shared by all penalties.
class CrossValidation {
 public:
  CrossValidation(const RegressionData& data, const Design& design) : design_(design) {
    const int count = 1 + *std::max_element(data.folds.begin(), data.folds.end());
    for (int fold = 0; fold < count; ++fold) {
      std::vector<Index> rows;
      for (std::size_t n = 0; n < data.folds.size(); ++n) {
        if (data.folds[n] == fold) rows.push_back(static_cast<Index>(n));
      }
      Fold& part = folds_.emplace_back();
      part.regressors = design.regressors(rows, Eigen::all);
      part.targets = data.targets(rows, Eigen::all);
      part.normal = part.regressors.transpose() * part.regressors;
      part.right = part.regressors.transpose() * part.targets;
      frames_ += static_cast<double>(rows.size());
    }
  }

  double error(const Penalty& penalty) const {
    double sum = 0;
    for (const Fold& held_out : folds_) {
      MatrixXd normal = MatrixXd::Zero(held_out.normal.rows(), held_out.normal.cols());
      MatrixXd right = MatrixXd::Zero(held_out.right.rows(), held_out.right.cols());
      for (const Fold& fold : folds_) {
        if (&fold == &held_out) continue;
        normal += fold.normal;
        right += fold.right;
      }
      const double frames = frames_ - static_cast<double>(held_out.targets.rows());
      const MatrixXd weights = solve(design_, std::move(normal), right, penalty, frames);
      sum += (held_out.regressors * weights - held_out.targets).squaredNorm();
    }
    return std::sqrt(sum / frames_);
  }

 private:
  struct Fold {
    MatrixXd regressors, targets, normal, right;
  };
  const Design& design_;
  std::vector<Fold> folds_;
  double frames_ = 0;
};

}  // namespace

Regression fit_regression(const RegressionData& data, int centre_count) {
  Regression best;
  best.centres = choose_centres(data, centre_count);
  const bool has_kernels = best.centres.rows() > 0;
  const double median = median_distance(best.centres);
  best.validation_error = std::numeric_limits<double>::infinity();
  Penalty best_penalty;
  for (const double width : kWidths) {
    const double inverse_width2 = 0.5 / std::pow(width * median, 2);
    const Design design = make_design(data, best.centres, inverse_width2);
    const CrossValidation validation(data, design);
    const auto consider = [&](const Penalty& penalty) {
      const double error = validation.error(penalty);
      if (!(error < best.validation_error)) return;
      best.validation_error = error;
      best.inverse_width2 = inverse_width2;
      best_penalty = penalty;
    };
    for (const double kernel : kKernelPenalties) {
      consider({best_penalty.linear, kernel});
      if (!has_kernels) break;
    }
    for (const double linear : kLinearPenalties) consider({linear, best_penalty.kernel});
    if (!has_kernels) break;
  }
  const Design design = make_design(data, best.centres, best.inverse_width2);
  const MatrixXd& x = design.regressors;
  best.weights =
      solve(design, x.transpose() * x, x.transpose() * data.targets, best_penalty, static_cast<double>(x.rows()));
  return best;
}

std::vector<int> blocked_folds(const std::vector<int>& takes, int run, int count) {
  std::vector<int> folds;
  int position = 0, block = 0;
  for (std::size_t n = 0; n < takes.size(); ++n) {
    if (n > 0 && (takes[n] != takes[n - 1] || position == run)) {
      ++block;
      position = 0;
    }
    const bool guard = position == run - 1;
    folds.push_back(guard ? -1 : block % count);
    ++position;
  }
  return folds;
}

}  // namespace bodyopt
