// A joint that all of the skin hangs under: it is no part of a pose to learn.

#include <gtest/gtest.h>

#include "runtime/coverage/expected_error.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "runtime/host/rig.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/detached_limb.h"
#include "tests/support/trained_basis.h"
#include "trainer/train/features/features.h"
#include "trainer/train/judge/test_errors.h"

namespace bodyopt::trainer {
namespace {

// The limb below one joint more, which moves no skin of its own: joint 0; the limb's root is joint 1.
Character hung_limb() {
  Character limb = limb_character();
  for (Joint& joint : limb.skeleton.joints) ++joint.parent;
  Joint above;
  above.name = "world";
  limb.skeleton.joints.insert(limb.skeleton.joints.begin(), above);
  for (auto& weights : limb.weights) {
    for (JointWeight& weight : weights) ++weight.joint;
  }
  return limb;
}

SampleSet hung_samples() {
  SampleSet set = limb_samples(60, 10);
  set.character = hung_limb();
  for (Muscle& muscle : set.muscles) {
    for (MusclePoint& point : muscle.path) ++point.joint;
  }
  for (std::vector<Sample>* samples : {&set.train, &set.heldout}) {
    for (Sample& sample : *samples) sample.pose.joints.insert(sample.pose.joints.begin(), JointTransform{});
  }
  return set;
}

TEST(LearnedFeatures, AJointThatAllOfTheSkinHangsUnderCountsAsNotTurning) {
  const std::vector<JointFeatures> expected = {{1, 1}, {2, 1}, {3, 2}};
  EXPECT_EQ(learned_features(hung_limb(), {}), expected);
}

TEST(LearnedFeatures, OfOtherCharactersAreTheUsualOnes) {
  EXPECT_TRUE(learned_features(limb_character(), {}).empty());
  Character bent_below = hung_limb();  // some skin stays where it is
  bent_below.weights.front() = {{0, 1}};
  EXPECT_TRUE(learned_features(bent_below, {}).empty());
}

TEST(LearnedFeatures, ADetachedFootIsSeenFromItsLimb) {
  const std::vector<JointFeatures> expected = {{1, 3}, {2, 2}, {3, 2}};  // the limb is all of the skin
  EXPECT_EQ(learned_features(detached_limb(), {}), expected);
}

// The tip slides along the limb, and the skin behind it swells: no rotation tells by how much.
SampleSet sliding_samples() {
  SampleSet set = limb_samples(80, 20);
  for (std::vector<Sample>* samples : {&set.train, &set.heldout}) {
    for (Sample& sample : *samples) {
      const double slide = 0.05 * std::sin(2.7 * sample.frame);
      sample.pose.joints[2].translation[2] += slide;
      Character swollen = set.character;
      for (Eigen::Index v = 0; v < swollen.vertices.rows(); ++v) {
        const double along = (swollen.vertices(v, 2) - 0.4) / 0.05;
        swollen.vertices.row(v).head<2>() *= 1 + 4 * slide * std::exp(-along * along);
      }
      sample.shape = limb_truth(swollen, {}, sample.pose);
    }
  }
  return set;
}

TEST(LearnedFeatures, AJointThatSlidesHasItsPlace) {
  const SampleSet set = sliding_samples();
  const double extent = longest_extent(set.character.vertices);
  const std::vector<JointFeatures> expected = {{1, 0}, {2, 1}, {2, 1, {0, 0, 0, 1}, {0, 0, 0, 1}, 10 / extent}};
  EXPECT_EQ(learned_features(set.character, poses_of(set.train)), expected);
  const std::vector<const Pose*> few(27, &set.train[10].pose);
  EXPECT_TRUE(learned_features(set.character, few).empty());
  // Half a hundredth of the extent is no slide.
  Pose pose = bind_pose(set.character.skeleton);
  pose.joints[2].translation[0] += 0.005 * extent;
  EXPECT_TRUE(learned_features(set.character, std::vector<const Pose*>(80, &pose)).empty());
}

TEST(LearnedFeatures, WhatASlideDoesIsLearned) {
  const SampleSet set = sliding_samples();
  const Basis basis = trained_basis(set, {});
  const MethodErrors errors = test_errors(basis, set).front().errors;
  EXPECT_LT(errors.full, 0.3 * errors.ddm);
}

TEST(LearnedFeatures, ABodyThatLeansIsInNoOtherPoseThanTrained) {
  const SampleSet set = hung_samples();
  const Basis basis = trained_basis(set, {.components = 16, .centres = 20});
  const Pose& upright = set.heldout[7].pose;
  Pose leaning = upright;
  const Quat lean = axis_angle({1, 0, 0}, 0.9);
  leaning.joints[1].rotation = lean * leaning.joints[1].rotation;
  EXPECT_EQ(pose_rig(basis.skeleton, leaning).joint_features, pose_rig(basis.skeleton, upright).joint_features);

  const ErrorExpectation expectation(basis);
  Deformer deformer(basis, {.name = "cpu"});
  const Evaluation standing = deformer.evaluate({&upright, 1}), leant = deformer.evaluate({&leaning, 1});
  const double expected_mm = expectation.of(standing, 0).rms_mm;
  EXPECT_NEAR(expectation.of(leant, 0).rms_mm, expected_mm, 1e-3 * expected_mm);

  const std::vector<float>&stands = standing.positions, &leans = leant.positions;
  const auto turn = rotation_matrix(lean);
  double furthest = 0;
  for (std::size_t v = 0; v < stands.size(); v += 3) {
    for (std::size_t i = 0; i < 3; ++i) {
      double turned = 0;
      for (std::size_t k = 0; k < 3; ++k) turned += turn[i][k] * double{stands[v + k]};
      furthest = std::max(furthest, std::abs(turned - double{leans[v + i]}));
    }
  }
  EXPECT_LT(furthest, 1e-5);
}

}  // namespace
}  // namespace bodyopt::trainer
