// Feature selection against least squares with every choice of columns.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <random>

#include "tests/support/textbook_algebra.h"
#include "trainer/train/regression/regress.h"

namespace bodyopt::trainer {
namespace {

Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

// Share of the targets' energy that least squares with some columns explains.
double explained(const Eigen::MatrixXd& features, const std::vector<Eigen::Index>& columns,
                 const Eigen::MatrixXd& targets) {
  const Eigen::MatrixXd x = features(Eigen::all, columns);
  const Eigen::MatrixXd left = targets - x * testing::textbook_solve(x, targets);
  return 1 - left.squaredNorm() / targets.squaredNorm();
}

TEST(SelectFeatures, EachIsTheOneThatExplainsMost) {
  const Eigen::MatrixXd features = random_matrix(300, 12, 1);
  const Eigen::MatrixXd targets = features * random_matrix(12, 3, 2) + random_matrix(300, 3, 3);
  std::vector<Eigen::Index> chosen;
  double total = 0;
  for (const SelectedFeature& next : select_features(features, targets, 5)) {
    double best = 0;
    for (Eigen::Index f = 0; f < 12; ++f) {
      std::vector<Eigen::Index> with = chosen;
      with.push_back(f);
      best = std::max(best, explained(features, with, targets));
    }
    chosen.push_back(next.column);
    total += next.gain;
    EXPECT_NEAR(explained(features, chosen, targets), best, 1e-9);
    EXPECT_NEAR(total, best, 1e-9);
  }
  EXPECT_EQ(chosen.size(), 5u);
}

TEST(SelectFeatures, TakesNothingTwiceAndNoNoise) {
  Eigen::MatrixXd features = random_matrix(200, 6, 4);
  features.col(3) = 2 * features.col(1);                      // tells nothing new
  features.col(4) = features.col(0) - 0.5 * features.col(2);  // nor this
  features.col(5) *= 1e-3;
  const Eigen::MatrixXd targets = features.leftCols(3) * random_matrix(3, 2, 5);
  EXPECT_EQ(select_features(features, targets, 6).size(), 3u);
  EXPECT_TRUE(select_features(features, Eigen::MatrixXd::Zero(200, 2), 6).empty());
  EXPECT_TRUE(select_features(Eigen::MatrixXd(200, 0), targets, 6).empty());
}

// What many features that mean nothing explain of few frames is chance.
TEST(SelectFeatures, LuckIsNotTaken) {
  const Eigen::MatrixXd features = random_matrix(400, 80, 6);
  const Eigen::MatrixXd targets = features.leftCols(2) * random_matrix(2, 5, 7) + 0.5 * random_matrix(400, 5, 8);
  const std::vector<SelectedFeature> selected = select_features(features, targets, 80);
  ASSERT_GE(selected.size(), 2u);
  EXPECT_LT(selected[0].column, 2u);
  EXPECT_LT(selected[1].column, 2u);
  EXPECT_LE(selected.size(), 3u);
}

// A muscle flexed in a few frames moves little of what all frames move, and is what those frames are there for.
TEST(SelectFeatures, WhatSomebodyMovesNeedNotOutdoChance) {
  Eigen::MatrixXd features = random_matrix(200, 6, 4);
  features.col(5).setZero();
  features.col(5).topRows(8).setOnes();
  Eigen::MatrixXd targets = features.leftCols(2) * random_matrix(2, 3, 5) + 0.3 * random_matrix(200, 3, 8);
  targets.col(0) += 0.2 * features.col(5);
  const auto takes = [&](std::span<const Eigen::Index> deliberate) {
    const std::vector<SelectedFeature> selected = select_features(features, targets, 6, deliberate);
    return std::ranges::find(selected, 5u, &SelectedFeature::column) != selected.end();
  };
  EXPECT_FALSE(takes({}));
  EXPECT_TRUE(takes(std::array<Eigen::Index, 1>{5}));
}

}  // namespace
}  // namespace bodyopt::trainer
