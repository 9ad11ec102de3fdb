// What training showed of joints, alone and together.
#include <gtest/gtest.h>

#include <random>

#include "runtime/host/fade.h"
#include "runtime/host/rig.h"
#include "trainer/train/features/features.h"

namespace bodyopt::trainer {
namespace {

// A root and two joints that have features, one below the other.
Skeleton chain() {
  Skeleton skeleton;
  skeleton.joints.resize(3);
  for (int j = 0; j < 3; ++j) {
    skeleton.joints[static_cast<std::size_t>(j)].name = "joint" + std::to_string(j);
    skeleton.joints[static_cast<std::size_t>(j)].parent = j - 1;
  }
  return skeleton;
}

// Both joints turn by their first feature, half a radian either way: the second by half of the first's, or on its own.
RawFeatures turns(bool coupled) {
  constexpr int kFrames = 400;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> angle(-0.5f, 0.5f);
  RawFeatures raw = RawFeatures::Zero(kFrames, 18);
  for (int n = 0; n < kFrames; ++n) {
    raw(n, 0) = angle(random);
    raw(n, 9) = coupled ? raw(n, 0) / 2 : angle(random);
  }
  return raw;
}

std::vector<int> five_folds(Eigen::Index frames) {
  std::vector<int> folds;
  for (Eigen::Index n = 0; n < frames; ++n) folds.push_back(static_cast<int>(n % 5));
  return folds;
}

ResidualTable trained_on(const RawFeatures& raw) {
  ResidualTable residual;
  residual.fade = joint_manifold(chain(), raw, five_folds(raw.rows()));
  for (Eigen::Index k = 0; k < raw.cols(); ++k) {
    residual.features.push_back({raw.col(k).minCoeff(), raw.col(k).maxCoeff(), 0, 1});
  }
  return residual;
}

std::vector<double> off(const ResidualTable& residual, float first, float second) {
  std::vector<float> features(18, 0.0f);
  features[0] = first;
  features[9] = second;
  return joints_off(residual, features);
}

TEST(JointManifold, CoupledJointsThatPartStandOff) {
  ASSERT_EQ(feature_joints(chain()).size(), 2u);
  const ResidualTable residual = trained_on(turns(true));
  for (const double angle : off(residual, 0.4f, 0.2f)) EXPECT_EQ(angle, 0);
  // Each within its range, but by 0.4 / sqrt(1.25) radians off the line that both were on.
  for (const double squared : off(residual, 0.4f, -0.2f)) EXPECT_NEAR(squared, 0.16 / 1.25, 1e-3);
}

TEST(JointManifold, JointsThatTurnedAloneDoNot) {
  const ResidualTable residual = trained_on(turns(false));
  for (const double squared : off(residual, 0.4f, -0.2f)) EXPECT_EQ(squared, 0);
  for (const double squared : off(residual, 0.4f, 0.45f)) EXPECT_EQ(squared, 0);
}

TEST(JointManifold, BeyondTheirRangeJointsStandOffByThemselves) {
  const std::vector<double> squared = off(trained_on(turns(false)), 0.0f, 1.5f);
  EXPECT_EQ(squared[0], 0);
  EXPECT_NEAR(squared[1], 1, 0.02);
}

// One frame in ten leaves the line by as much as 0.1 radians: that is usual, and twice as much is not.
TEST(JointManifold, WhatIsUsualInOtherFoldsIsTolerated) {
  RawFeatures raw = turns(true);
  for (Eigen::Index n = 0; n < raw.rows(); n += 10) raw(n, 9) += (n / 10 % 2 == 0) ? 0.05f : -0.05f;
  const ResidualTable residual = trained_on(raw);
  for (const double squared : off(residual, 0.2f, 0.14f)) EXPECT_EQ(squared, 0);
  for (const double squared : off(residual, 0.2f, 0.3f)) EXPECT_GT(squared, 0.01);
}

TEST(JointManifold, TurnsAreMeanSquares) {
  RawFeatures raw = RawFeatures::Zero(2, 18);
  raw(0, 3) = 0.5f;
  raw(1, 4) = 1;
  raw(1, 17) = 2;
  EXPECT_EQ(joint_turns(raw, 2), (std::vector<double>{0.625, 2}));
}

}  // namespace
}  // namespace bodyopt::trainer
