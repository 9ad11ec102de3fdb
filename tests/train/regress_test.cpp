// Regression and principal components against their textbook definitions.
#include "trainer/train/regression/regress.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>

#include "runtime/core/half.h"
#include "tests/support/textbook_algebra.h"
#include "trainer/train/regression/components.h"

namespace bodyopt::trainer {
namespace {

RegressionData random_data(int frames, int features, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  RegressionData data;
  data.features = Eigen::MatrixXd::NullaryExpr(frames, features, [&] { return uniform(random); });
  data.rest = Eigen::RowVectorXd::Constant(features, 0.25);
  data.folds = blocked_folds(std::vector<int>(static_cast<std::size_t>(frames), 0), 10, 5);
  return data;
}

// The run-time form: [f, phi(f)] times the weights, less the same at rest.
Eigen::MatrixXd predict(const Regression& fit, const Eigen::MatrixXd& features, const Eigen::RowVectorXd& rest) {
  const auto row = [&](const Eigen::RowVectorXd& f) -> Eigen::RowVectorXd {
    Eigen::RowVectorXd regressors(fit.weights.rows());
    regressors.head(f.size()) = f;
    for (Eigen::Index m = 0; m < fit.centres.rows(); ++m) {
      regressors[f.size() + m] = std::exp(-(f - fit.centres.row(m)).squaredNorm() * fit.inverse_width2);
    }
    return regressors * fit.weights;
  };
  Eigen::MatrixXd result(features.rows(), fit.weights.cols());
  for (Eigen::Index n = 0; n < features.rows(); ++n) result.row(n) = row(features.row(n)) - row(rest);
  return result;
}

Eigen::MatrixXd smooth_truth(const Eigen::MatrixXd& features, const Eigen::RowVectorXd& rest) {
  const auto value = [](const Eigen::RowVectorXd& f) {
    return Eigen::RowVector2d(f[0] * f[1] + std::sin(2 * f[2]), f[0] - std::cos(f[1] + f[2]));
  };
  Eigen::MatrixXd result(features.rows(), 2);
  for (Eigen::Index n = 0; n < features.rows(); ++n) result.row(n) = value(features.row(n)) - value(rest);
  return result;
}

// A frame of weight 2 is as two frames.
TEST(Regression, AFrameCountsAsOftenAsItsWeight) {
  RegressionData once = random_data(60, 3, 21);
  once.targets = Eigen::MatrixXd::Random(60, 2);
  once.folds.assign(60, 0);
  for (std::size_t n = 30; n < 60; ++n) once.folds[n] = 1;
  RegressionData twice = once;
  once.weights = Eigen::VectorXd::Ones(60);
  once.weights.head(10).setConstant(2);
  once.weights.tail(5).setZero();
  twice.features.conservativeResize(70, Eigen::NoChange);
  twice.features.bottomRows(10) = once.features.topRows(10);
  twice.targets.conservativeResize(70, Eigen::NoChange);
  twice.targets.bottomRows(10) = once.targets.topRows(10);
  const std::vector<int> more(10, 0);
  twice.folds.insert(twice.folds.end(), more.begin(), more.end());
  const auto without = [](RegressionData& data) {  // frames 55 to 59
    data.weights = Eigen::VectorXd::Ones(70);
    data.weights.segment(55, 5).setZero();
  };
  without(twice);
  const Regression a = fit_regression(once, 0), b = fit_regression(twice, 0);
  EXPECT_EQ(a.penalty.linear, b.penalty.linear);
  EXPECT_NEAR(a.validation_error, b.validation_error, 1e-9);
  EXPECT_LT((a.weights - b.weights).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((a.errors - b.errors.topRows(60)).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(Regression, LearnsALinearMapWithoutKernels) {
  RegressionData data = random_data(200, 4, 1);
  const Eigen::MatrixXd map = Eigen::MatrixXd::Random(4, 3);
  data.targets = (data.features.rowwise() - data.rest) * map;
  const Regression fit = fit_regression(data, 0);
  EXPECT_EQ(fit.centres.rows(), 0);
  EXPECT_LT((fit.weights - map).cwiseAbs().maxCoeff(), 2e-3);
}

TEST(Regression, KernelsLearnWhatIsNotLinear) {
  RegressionData data = random_data(400, 3, 2);
  data.targets = smooth_truth(data.features, data.rest);
  const RegressionData fresh = random_data(100, 3, 3);
  const Eigen::MatrixXd truth = smooth_truth(fresh.features, fresh.rest);
  const auto error = [&](int centres) {
    return (predict(fit_regression(data, centres), fresh.features, data.rest) - truth).norm() / truth.norm();
  };
  const double linear = error(0), kernels = error(120);
  EXPECT_GT(linear, 0.2);
  EXPECT_LT(kernels, 0.02);
}

// Every frame by the fit of the other folds: ridge regressions done by hand, one of whose penalties was chosen.
TEST(Regression, ErrorsAreThoseOfFramesHeldOut) {
  RegressionData data = random_data(100, 20, 10);
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  data.targets = Eigen::MatrixXd::NullaryExpr(100, 2, [&] { return normal(random); });
  data.targets.col(0) += 2 * data.features.col(3);
  const Regression fit = fit_regression(data, 0);
  std::vector<Eigen::Index> inside, outside;
  double held_out = 0;
  for (Eigen::Index n = 0; n < 100; ++n) {
    const int fold = data.folds[static_cast<std::size_t>(n)];
    EXPECT_EQ(fit.errors.row(n).isZero(0), fold < 0) << n;
    if (fold < 0) continue;
    (fold == 2 ? inside : outside).push_back(n);
    held_out += 1;
  }
  EXPECT_NEAR(fit.errors.norm() / std::sqrt(held_out), fit.validation_error, 1e-12);
  const Eigen::MatrixXd moved = data.features.rowwise() - data.rest;
  const Eigen::MatrixXd known = moved(outside, Eigen::all), targets = data.targets(outside, Eigen::all);
  double nearest = 1e9;
  for (const double penalty : {1e-4, 1e-3, 1e-2, 1e-1}) {
    Eigen::MatrixXd normal_matrix = known.transpose() * known;
    normal_matrix.diagonal().array() += penalty * static_cast<double>(outside.size());
    const Eigen::MatrixXd map = testing::textbook_solve(normal_matrix, known.transpose() * targets);
    const Eigen::MatrixXd off = moved(inside, Eigen::all) * map - data.targets(inside, Eigen::all);
    nearest = std::min(nearest, (off - fit.errors(inside, Eigen::all)).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(nearest, 1e-6);
}

TEST(Regression, IsZeroAtRest) {
  RegressionData data = random_data(100, 3, 4);
  data.targets = smooth_truth(data.features, data.rest);
  EXPECT_LT(predict(fit_regression(data, 40), data.rest, data.rest).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Regression, FindsNoMeaningInNoise) {
  RegressionData data = random_data(100, 3, 5);
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  data.targets = Eigen::MatrixXd::NullaryExpr(100, 2, [&] { return normal(random); });
  const Regression fit = fit_regression(data, 60);
  const double spread = std::sqrt(data.targets.rowwise().squaredNorm().mean());
  EXPECT_GT(fit.validation_error, 0.9 * spread);
  EXPECT_LT(fit.validation_error, 1.5 * spread);
}

TEST(Regression, BearsConstantFeaturesAndRepeatedFrames) {
  RegressionData data = random_data(60, 3, 7);
  data.features.col(1).setZero();
  data.rest[1] = 0;
  for (Eigen::Index n = 1; n < 60; n += 2) data.features.row(n) = data.features.row(n - 1);
  data.targets = smooth_truth(data.features, data.rest);
  const Regression fit = fit_regression(data, 60);
  EXPECT_TRUE(fit.weights.allFinite());
  EXPECT_LE(fit.centres.rows(), 31);
}

// Of the frames that were chosen, however small or large their features.
TEST(Regression, CentresAreRoundedToNormalHalves) {
  RegressionData data = random_data(50, 3, 8);
  data.features.col(0) *= 1e-4;
  data.features(7, 2) = 1e6;
  data.targets = Eigen::MatrixXd::Ones(50, 1);
  const Regression fit = fit_regression(data, 51);
  ASSERT_EQ(fit.centres.rows(), 51);
  for (const double value : fit.centres.reshaped()) {
    EXPECT_EQ(double{float_from_half(half_from_float(static_cast<float>(value)))}, value);
    EXPECT_TRUE(value == 0 || std::abs(value) >= 0x1p-14) << value;
  }
  EXPECT_EQ(fit.centres.row(0), data.rest);
  EXPECT_EQ(fit.centres.maxCoeff(), 65504);
  EXPECT_GT((fit.centres.col(0).array() == 0).count(), 10);
  for (Eigen::Index m = 0; m < fit.centres.rows(); ++m) {
    const Eigen::RowVectorXd centre = fit.centres.row(m).leftCols(2);
    const Eigen::VectorXd apart = (data.features.leftCols(2).rowwise() - centre).cwiseAbs().rowwise().maxCoeff();
    EXPECT_LE(m == 0 ? 0 : apart.minCoeff(), 0x1p-11) << "centre " << m;
  }
}

TEST(Regression, NeighbouringFramesNeverStandOnBothSides) {
  std::vector<int> takes(95, 0);
  takes.resize(190, 1);
  const std::vector<int> folds = blocked_folds(takes, 8, 5);
  for (std::size_t n = 1; n < folds.size(); ++n) {
    if (takes[n] != takes[n - 1] || folds[n] < 0 || folds[n - 1] < 0) continue;
    EXPECT_EQ(folds[n], folds[n - 1]) << "frames " << n - 1 << " and " << n;
  }
  for (int fold = 0; fold < 5; ++fold) EXPECT_GT(std::count(folds.begin(), folds.end(), fold), 20);
}

// Of a take that one fold had whole, the others would know nothing.
TEST(Regression, EveryFoldHoldsOutSomeOfEveryTake) {
  std::vector<int> takes(63, 0);
  takes.resize(63 + 18, 1);
  takes.resize(63 + 18 + 400, 2);
  const std::vector<int> folds = blocked_folds(takes, 20, 5);
  for (int take = 0; take < 3; ++take) {
    std::vector<int> frames(5, 0);
    for (std::size_t n = 0; n < folds.size(); ++n) {
      if (takes[n] == take && folds[n] >= 0) ++frames[static_cast<std::size_t>(folds[n])];
    }
    for (const int count : frames) EXPECT_GT(count, 0) << "of take " << take;
  }
  EXPECT_EQ(std::count(folds.begin() + 81, folds.begin() + 101, folds[81]), 19);  // and a guard
}

TEST(Components, AreTheWeightedSingularVectors) {
  std::mt19937_64 random(8);
  std::normal_distribution<float> normal;
  constexpr int kFrames = 40, kVertices = 30;
  Displacements displacements = Displacements::NullaryExpr(kFrames, 3 * kVertices, [&] { return normal(random); });
  for (int n = 0; n < kFrames; ++n) displacements.row(n) *= std::pow(0.7f, static_cast<float>(n));
  RegionWeights region;
  Eigen::MatrixXd weighted(kFrames, 3 * kVertices / 2);
  for (std::uint32_t v = 0; v < kVertices; v += 2) {
    region.vertices.push_back(v);
    region.weights.push_back(0.1 + 0.03 * v);
    weighted.middleCols(3 * v / 2, 3) =
        displacements.middleCols(3 * v, 3).cast<double>() * std::sqrt(region.weights.back());
  }
  const Components components = principal_components(displacements, region, 6, 1);
  const testing::TextbookSvd svd = testing::textbook_svd(weighted);
  ASSERT_EQ(components.coefficients.cols(), 6);
  for (Eigen::Index k = 0; k < 6; ++k) {
    const double norm = components.coefficients.col(k).norm();
    EXPECT_NEAR(norm, svd.values[k], 1e-4 * svd.values[0]);
    EXPECT_NEAR(std::abs(components.coefficients.col(k).dot(svd.left.col(k))) / norm, 1, 1e-3);
  }
  // With all components, coefficients times basis give the displacements back, region weights included.
  const Components all = principal_components(displacements, region, kFrames, 1);
  const Eigen::MatrixXd rebuilt = all.coefficients * all.basis;
  for (std::size_t k = 0; k < region.vertices.size(); ++k) {
    const Eigen::MatrixXd expected =
        displacements.middleCols(3 * region.vertices[k], 3).cast<double>() * region.weights[k];
    EXPECT_LT((rebuilt.middleCols(3 * static_cast<Eigen::Index>(k), 3) - expected).cwiseAbs().maxCoeff(), 1e-3);
  }
}

// Energies are those of every frame, and the components of some frames put back on their own basis give the same.
TEST(Components, OtherFramesGoOnTheSameBasis) {
  std::mt19937_64 random(9);
  std::normal_distribution<float> normal;
  const Displacements displacements = Displacements::NullaryExpr(20, 30, [&] { return normal(random); }) *
                                      Displacements::NullaryExpr(30, 30, [&] { return normal(random); }).eval();
  const RegionWeights region{"", {0, 3, 4, 9}, {1, 0.5, 0.2, 0.8}};
  Components components = principal_components(displacements, region, 5, 1);
  for (Eigen::Index n = 0; n < 20; ++n) {
    double energy = 0;
    for (std::size_t v = 0; v < 4; ++v) {
      energy +=
          region.weights[v] * displacements.row(n).segment<3>(3 * region.vertices[v]).cast<double>().squaredNorm();
    }
    EXPECT_NEAR(components.energy[n], energy, 1e-5 * energy);
    EXPECT_NEAR(components.truncated[n], energy - components.coefficients.row(n).squaredNorm(), 1e-5 * energy);
  }
  EXPECT_TRUE(component_lengths(components, region).isOnes(1e-5));
  components.basis.row(2) /= 3;
  components.coefficients.col(2) *= 3;
  EXPECT_NEAR(component_lengths(components, region)[2], 1.0 / 3, 1e-5);
  const Displacements some = displacements(std::vector<Eigen::Index>{7, 2}, Eigen::all);
  const Components again = on_basis_of(components, some, region);
  for (const auto& [row, frame] : {std::pair(0, 7), std::pair(1, 2)}) {
    EXPECT_LT((again.coefficients.row(row) - components.coefficients.row(frame)).norm(),
              1e-4 * components.coefficients.row(frame).norm());
    EXPECT_NEAR(again.truncated[row], components.truncated[frame], 1e-4 * components.energy[frame]);
  }
}

TEST(Components, NoMotionGivesNone) {
  const Displacements still = Displacements::Zero(20, 30);
  const Components components = principal_components(still, {"", {0, 3, 5}, {1, 0.5, 1}}, 6, 1);
  EXPECT_EQ(components.coefficients.cols(), 0);
  EXPECT_EQ(components.basis.rows(), 0);
}

}  // namespace
}  // namespace bodyopt::trainer
