// Poses that are known again where they are the same to what was learned from them, and not where they are others.
#include "trainer/train/data/learned_poses.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/support/capsule_limb.h"

namespace bodyopt::trainer {
namespace learned_poses_test {

class LearnedPosesTest : public ::testing::Test {
 protected:
  LearnedPosesTest() {
    set_.controls = {"biceps"};
    for (Sample& sample : set_.train) sample.pose.controls = {0};
    basis_.metadata[kLearnedPoses] = learned_poses_text(set_);
  }

  // How many training frames are known again after `change`.
  template <typename Change>
  std::size_t known(const Change& change) const {
    const LearnedPoses learned(basis_, set_);
    return static_cast<std::size_t>(std::count_if(set_.train.begin(), set_.train.end(), [&](const Sample& sample) {
      Pose pose = sample.pose;
      change(pose);
      return learned.has(pose);
    }));
  }

  SampleSet set_ = limb_samples(60, 0);
  Basis basis_;
};

TEST_F(LearnedPosesTest, AreThoseWhereverTheRootIs) {
  EXPECT_EQ(known([](Pose& pose) {
              pose.joints[0].translation[0] += 1;
              pose.joints[0].rotation = {0, 0, 1, 0};
            }),
            60u);
}

TEST_F(LearnedPosesTest, AreThoseOfAClipThatWasWrittenAgain) {
  const auto negated = [](Pose& pose) {
    for (JointTransform& joint : pose.joints) {
      for (double& x : joint.rotation) x = -x;
    }
    pose.controls = {-0.0f};
  };
  EXPECT_EQ(known(negated), 60u);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> error(-1e-7, 1e-7);  // of single precision
  const auto in_single_precision = [&](Pose& pose) {
    for (JointTransform& joint : pose.joints) {
      for (double& x : joint.rotation) x += error(random);
    }
  };
  EXPECT_GE(known(in_single_precision), 55u);
}

TEST_F(LearnedPosesTest, OthersAreNone) {
  EXPECT_EQ(known([](Pose& pose) { pose.joints.back().rotation[0] += 0.01; }), 0u);
  EXPECT_EQ(known([](Pose& pose) { pose.controls = {0.01f}; }), 0u);
}

TEST_F(LearnedPosesTest, ABasisThatLearnedNoneTells) {
  set_.train.clear();
  basis_.metadata[kLearnedPoses] = learned_poses_text(set_);
  EXPECT_TRUE(tells_learned_poses(basis_));
  EXPECT_FALSE(tells_learned_poses(Basis{}));
  EXPECT_FALSE(LearnedPoses(basis_, set_).has(bind_pose(set_.character.skeleton)));
}

}  // namespace learned_poses_test
}  // namespace bodyopt::trainer
