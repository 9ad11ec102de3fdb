// From the features of a region to its coefficients: a linear ridge fit, then Gaussian kernels on what it leaves.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace bodyopt {

struct FitProblem {
  Eigen::MatrixXd features;      // frames x F, standardised
  Eigen::RowVectorXd rest;       // F, features of the rest pose
  Eigen::MatrixXd coefficients;  // frames x K
  std::vector<int> folds;        // frames; the part of the cross-validation each frame is left out in
  int most_centres = 0;
};

// c = weights [1, f, phi(f)], zero at rest.
struct FitResult {
  Eigen::MatrixXd centres;  // M x F
  double inverse_width2 = 0;
  Eigen::MatrixXd weights;  // K x (1 + F + M)
};

// Regularisation and kernel width are chosen by cross-validation over the folds.
FitResult fit_coefficients(const FitProblem& problem);

// Fold of each of `frames` frames in time order: blocks of neighbours stay together.
std::vector<int> time_folds(std::size_t frames);

}  // namespace bodyopt
