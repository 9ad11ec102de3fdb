// What few directions tell of many features.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <random>

#include "base/linear_algebra.h"
#include "trainer/train/regression/regress.h"

namespace bodyopt::trainer {
namespace {

Eigen::MatrixXd noise(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

// Targets follow two directions of six features, the first twenty times as far.
TEST(Projection, FindsTheDirectionsThatTargetsFollow) {
  const Eigen::MatrixXd features = noise(500, 6, 1);
  const Eigen::MatrixXd two = orthonormal_basis(noise(6, 2, 2), 1e-6);
  Eigen::MatrixXd targets = features * two;
  targets.col(0) *= 20;
  const Eigen::MatrixXd found = projection(features, targets);
  ASSERT_EQ(found.rows(), 2);
  ASSERT_EQ(found.cols(), 6);
  EXPECT_NEAR(std::abs(found.row(0).dot(two.col(0))), 1, 1e-2);
  // Damped by the root of what follows from it.
  EXPECT_NEAR(std::abs(found.row(1).dot(two.col(1))), std::sqrt(1 / 20.0), 1e-2);
  EXPECT_NEAR(found.row(0).dot(found.row(1)), 0, 1e-2);
}

TEST(Projection, FeaturesThatTellNothingAreLeftOut) {
  const Eigen::MatrixXd features = noise(2000, 8, 3);
  const Eigen::MatrixXd found = projection(features, features.leftCols(1));
  ASSERT_EQ(found.rows(), 1);
  EXPECT_LT(found.rightCols(7).norm(), 0.01);
}

// Twins share what they tell.
TEST(Projection, CollinearFeaturesShareAlike) {
  Eigen::MatrixXd features = noise(300, 2, 4);
  features.col(1) = features.col(0);
  const Eigen::MatrixXd found = projection(features, features.leftCols(1));
  ASSERT_EQ(found.rows(), 1);
  EXPECT_NEAR(found(0, 0), found(0, 1), 1e-3);
  EXPECT_TRUE(found.allFinite());
}

TEST(Projection, NumbersAreThoseOfTheBasis) {
  const Eigen::MatrixXd features = noise(100, 5, 5);
  const Eigen::MatrixXd found = projection(features, noise(100, 3, 6));
  ASSERT_GT(found.rows(), 0);
  for (const double value : found.reshaped()) EXPECT_EQ(value, stored_half(value));
  EXPECT_EQ(projection(Eigen::MatrixXd(100, 0), noise(100, 3, 6)).rows(), 0);
  EXPECT_EQ(projection(features, Eigen::MatrixXd::Zero(100, 3)).rows(), 0);
}

}  // namespace
}  // namespace bodyopt::trainer
