#include "trainer/train/fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace bodyopt {
namespace {

constexpr int kFolds = 5;
constexpr double kLinearRidges[] = {1e-5, 1e-4, 1e-3, 1e-2, 1e-1};  // times the number of frames
constexpr double kKernelRidges[] = {1e-6, 1e-5, 1e-4, 1e-3, 1e-2};
constexpr double kWidths[] = {1, 2, 4};  // times the median distance between centres
constexpr double kJitter = 1e-7;         // on the kernel matrix, so that weights stay within single precision

// Least squares with the penalty tr(W^T penalty W), for all frames and for all but one fold.
class Ridge {
 public:
  Ridge(const Eigen::MatrixXd& inputs, const std::vector<int>& folds) : inputs_(inputs), folds_(folds) {
    for (int fold = 0; fold < kFolds; ++fold) {
      const Eigen::MatrixXd part = rows(inputs, fold);
      grams_.emplace_back(part.transpose() * part);
      total_ = fold == 0 ? grams_[0] : Eigen::MatrixXd(total_ + grams_.back());
    }
  }

  // fold < 0: all frames.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& outputs, const Eigen::MatrixXd& penalty, int fold) const {
    Eigen::MatrixXd matrix = total_ + penalty, right = inputs_.transpose() * outputs;
    if (fold >= 0) {
      matrix -= grams_[static_cast<std::size_t>(fold)];
      right -= rows(inputs_, fold).transpose() * rows(outputs, fold);
    }
    return matrix.ldlt().solve(right);
  }

  Eigen::MatrixXd rows(const Eigen::MatrixXd& matrix, int fold) const {
    std::vector<Eigen::Index> index;
    for (std::size_t f = 0; f < folds_.size(); ++f) {
      if (folds_[f] == fold) index.push_back(static_cast<Eigen::Index>(f));
    }
    return matrix(index, Eigen::all);
  }

 private:
  const Eigen::MatrixXd& inputs_;
  const std::vector<int>& folds_;
  std::vector<Eigen::MatrixXd> grams_;
  Eigen::MatrixXd total_;
};

Eigen::MatrixXd scaled_identity(Eigen::Index size, double scale) {
  return scale * Eigen::MatrixXd::Identity(size, size);
}

// The linear part, for all frames and with each fold left out.
struct Linear {
  Eigen::MatrixXd weights;                    // F x K
  std::vector<Eigen::MatrixXd> fold_weights;  // F x K each
};

Linear fit_linear(const Eigen::MatrixXd& inputs, const FitProblem& problem) {
  const Ridge ridge(inputs, problem.folds);
  double best_error = std::numeric_limits<double>::infinity();
  Linear best;
  Eigen::MatrixXd best_penalty;
  for (const double candidate : kLinearRidges) {
    const Eigen::MatrixXd penalty = scaled_identity(inputs.cols(), candidate * static_cast<double>(inputs.rows()));
    std::vector<Eigen::MatrixXd> folds;
    double error = 0;
    for (int fold = 0; fold < kFolds; ++fold) {
      folds.push_back(ridge.solve(problem.coefficients, penalty, fold));
      error += (ridge.rows(problem.coefficients, fold) - ridge.rows(inputs, fold) * folds.back()).squaredNorm();
    }
    if (error >= best_error) continue;
    best_error = error;
    best.fold_weights = std::move(folds);
    best_penalty = penalty;
  }
  best.weights = ridge.solve(problem.coefficients, best_penalty, -1);
  return best;
}

// Each next one the farthest from those chosen; the first is the farthest from rest.
std::vector<Eigen::Index> farthest_frames(const Eigen::MatrixXd& inputs, int most) {
  std::vector<Eigen::Index> chosen;
  Eigen::VectorXd nearest = inputs.rowwise().squaredNorm();
  while (static_cast<int>(chosen.size()) < most && static_cast<Eigen::Index>(chosen.size()) < inputs.rows()) {
    Eigen::Index next = 0;
    if (!(nearest.maxCoeff(&next) > 1e-12)) break;
    chosen.push_back(next);
    nearest = nearest.cwiseMin((inputs.rowwise() - inputs.row(next)).rowwise().squaredNorm());
  }
  return chosen;
}

Eigen::MatrixXd squared_distances(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  Eigen::MatrixXd distances = -2 * a * b.transpose();
  distances.colwise() += a.rowwise().squaredNorm();
  distances.rowwise() += b.rowwise().squaredNorm().transpose();
  return distances.cwiseMax(0);
}

double median_of(const Eigen::MatrixXd& distances) {
  std::vector<double> values(distances.data(), distances.data() + distances.size());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Eigen::MatrixXd gaussian(const Eigen::MatrixXd& distances2, double inverse_width2) {
  return (-inverse_width2 * distances2).array().exp();
}

// Kernel part on what the linear part leaves. `inputs` are relative to rest.
struct Kernels {
  double inverse_width2 = 0;
  Eigen::MatrixXd weights;  // M x K
};

Kernels fit_kernels(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& centres, const Linear& linear,
                    const FitProblem& problem) {
  const Eigen::MatrixXd between = squared_distances(centres, centres), to_frames = squared_distances(inputs, centres);
  const Eigen::RowVectorXd to_rest = centres.rowwise().squaredNorm().transpose();
  const double median = std::max(median_of(between), 1e-6);
  double best_error = std::numeric_limits<double>::infinity();
  Kernels best;
  for (const double width : kWidths) {
    const double inverse_width2 = 1 / (2 * width * width * median);
    const Eigen::RowVectorXd rest = (-inverse_width2 * to_rest).array().exp();
    const Eigen::MatrixXd phi = gaussian(to_frames, inverse_width2).rowwise() - rest;
    const Eigen::MatrixXd matrix = gaussian(between, inverse_width2) +
                                   scaled_identity(between.rows(), kJitter * static_cast<double>(between.rows()));
    const Ridge ridge(phi, problem.folds);
    for (const double candidate : kKernelRidges) {
      double error = 0;
      for (int fold = 0; fold < kFolds; ++fold) {
        const Eigen::MatrixXd left =
            problem.coefficients - inputs * linear.fold_weights[static_cast<std::size_t>(fold)];
        const Eigen::MatrixXd weights = ridge.solve(left, candidate * matrix, fold);
        error += (ridge.rows(left, fold) - ridge.rows(phi, fold) * weights).squaredNorm();
      }
      if (error >= best_error) continue;
      best_error = error;
      best.inverse_width2 = inverse_width2;
      best.weights = ridge.solve(problem.coefficients - inputs * linear.weights, candidate * matrix, -1);
    }
  }
  return best;
}

}  // namespace

FitResult fit_coefficients(const FitProblem& problem) {
  const Eigen::MatrixXd inputs = problem.features.rowwise() - problem.rest;
  const Linear linear = fit_linear(inputs, problem);
  const std::vector<Eigen::Index> frames = farthest_frames(inputs, problem.most_centres);
  const Eigen::MatrixXd centres = inputs(frames, Eigen::all);
  Kernels kernels{0, Eigen::MatrixXd(0, problem.coefficients.cols())};
  if (!frames.empty()) kernels = fit_kernels(inputs, centres, linear, problem);

  FitResult result;
  result.centres = problem.features(frames, Eigen::all);
  result.inverse_width2 = kernels.inverse_width2;
  const Eigen::VectorXd rest_kernels = (-kernels.inverse_width2 * centres.rowwise().squaredNorm()).array().exp();
  result.weights.resize(problem.coefficients.cols(), 1 + inputs.cols() + centres.rows());
  result.weights.col(0) =
      -linear.weights.transpose() * problem.rest.transpose() - kernels.weights.transpose() * rest_kernels;
  result.weights.middleCols(1, inputs.cols()) = linear.weights.transpose();
  result.weights.rightCols(centres.rows()) = kernels.weights.transpose();
  return result;
}

std::vector<int> time_folds(std::size_t frames) {
  const std::size_t block = std::clamp<std::size_t>(frames / (2 * kFolds), 1, 20);
  std::vector<int> folds;
  for (std::size_t k = 0; k < frames; ++k) folds.push_back(static_cast<int>(k / block % kFolds));
  return folds;
}

}  // namespace bodyopt
