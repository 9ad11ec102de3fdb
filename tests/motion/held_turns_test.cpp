#include "trainer/motion/held_turns.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "assets/characters/character.h"
#include "assets/clips/clip.h"
#include "tests/support/paths.h"
#include "tests/support/shared_data.h"

namespace bodyopt::trainer {
namespace held_turns_test {

constexpr double kDegree = std::numbers::pi / 180;

// An arm along x whose joints have axes of their own; a hinge at the elbow, a ball at the shoulder; the hand has no
// limits.
struct Arm {
  Arm() {
    const char* names[] = {"chest", "shoulder", "elbow", "hand"};
    Affine above;
    for (int j = 0; j < 4; ++j) {
      Joint joint;
      joint.name = names[j];
      joint.parent = j - 1;
      JointTransform world;
      world.translation = {0.3 * j, 1, 0};
      world.rotation = axis_angle({1, 2, 3}, 0.8 * j);
      joint.inverse_bind = inverse(affine_from(world));
      joint.bind = decompose(above * affine_from(world));
      above = joint.inverse_bind;
      skeleton.joints.push_back(joint);
    }
    limits.dofs = {{"swing", 10, -60, 80, {{1, {0, 1, 0}, 0.5}}},
                   {"raise", 0, -50, 90, {{1, {0, 0, 1}, 1}}},
                   {"roll", 0, -70, 40, {{1, {1, 0, 0}, -1}}},
                   {"flexion", 5, 0, 140, {{2, {0, 0, 1}, 1}}}};
  }

  // A pose within the limits whose joint is turned first by so much about an axis of the bind pose.
  Pose pose(const Angles& angles, std::size_t joint, const Vec3& axis, double degrees) const {
    Pose result = limited_pose(skeleton, limits, {angles});
    Quat world{0, 0, 0, 1};
    for (std::size_t j = 0; j <= joint; ++j) world = world * skeleton.joints[j].bind.rotation;
    Quat& own = result.joints[joint].rotation;
    own = normalized(own * (conjugate(world) * axis_angle(axis, degrees * kDegree) * world));
    return result;
  }

  std::vector<HeldTurn> held(const std::vector<Pose>& poses) const { return held_turns(limits, skeleton, poses); }

  Skeleton skeleton;
  JointLimits limits;
};

Angles random_within(const JointLimits& limits, std::mt19937& random) {
  Angles angles;
  for (const DegreeOfFreedom& dof : limits.dofs)
    angles.push_back(std::uniform_real_distribution(dof.min, dof.max)(random));
  return angles;
}

TEST(HeldTurns, ATwistOfTheElbowIsFoundWhateverTheArmDoes) {
  const Arm arm;
  std::mt19937 random(1);
  std::vector<Pose> poses;
  for (int k = 0; k < 50; ++k) poses.push_back(arm.pose(random_within(arm.limits, random), 2, {1, 0, 0}, 45));
  const std::vector<HeldTurn> held = arm.held(poses);
  ASSERT_EQ(held.size(), 1u);
  EXPECT_EQ(held[0].joint, 2u);
  EXPECT_NEAR(held[0].degrees, 45, 4);  // the hinge undoes some of it near its ends
  EXPECT_GT(held[0].axis[0], 0.95);
  EXPECT_EQ(held[0].share, 1);
  EXPECT_TRUE(describe(held[0], arm.skeleton, 50).starts_with("'elbow' is turned by 4"));
  EXPECT_NE(describe(held[0], arm.skeleton, 50).find("degrees about its length beyond its limits in every frame"),
            std::string::npos);
}

// Three angles reach any rotation within their ranges, in the order of the limits.
TEST(HeldTurns, PosesWithinTheLimitsAreNotBeyondThem) {
  const Arm arm;
  std::mt19937 random(2);
  for (int k = 0; k < 300; ++k) {
    const std::vector<Pose> one = {limited_pose(arm.skeleton, arm.limits, {random_within(arm.limits, random)})};
    EXPECT_TRUE(arm.held(one).empty()) << k;
  }
  EXPECT_TRUE(arm.held({}).empty());
}

TEST(HeldTurns, WhatComesAndGoesIsNotHeld) {
  const Arm arm;
  const Angles rest = rest_angles(arm.limits);
  const auto poses = [&](auto twist) {
    std::vector<Pose> result;
    for (int k = 0; k < 100; ++k) result.push_back(arm.pose(rest, 2, {1, 0, 0}, twist(k)));
    return result;
  };
  EXPECT_EQ(arm.held(poses([](int) { return 30; })).size(), 1u);
  EXPECT_TRUE(arm.held(poses([](int) { return 20; })).empty());                       // little
  EXPECT_TRUE(arm.held(poses([](int k) { return k % 2 == 0 ? 60 : -60; })).empty());  // to and fro
  EXPECT_TRUE(arm.held(poses([](int k) { return k % 2 == 0 ? 60 : 8; })).empty());    // more and less
  EXPECT_TRUE(arm.held(poses([](int k) { return k < 10 ? 0 : 60; })).empty());        // not from the beginning
  const std::vector<HeldTurn> mostly = arm.held(poses([](int k) { return k < 2 ? 0 : 60; }));
  ASSERT_EQ(mostly.size(), 1u);
  EXPECT_NEAR(mostly[0].share, 0.98, 1e-9);
  EXPECT_NE(describe(mostly[0], arm.skeleton, 100).find("in 98 % of the frames"), std::string::npos);
}

TEST(HeldTurns, HalfATurnIsHeldThoughItPassesHalfACircle) {
  const Arm arm;
  std::vector<Pose> poses;
  for (int k = 0; k < 40; ++k) poses.push_back(arm.pose(rest_angles(arm.limits), 2, {1, 0, 0}, 174 + k % 13));
  const std::vector<HeldTurn> held = arm.held(poses);
  ASSERT_EQ(held.size(), 1u);
  EXPECT_GT(held[0].degrees, 170);
  EXPECT_LE(held[0].degrees, 180);
}

TEST(HeldTurns, AClipOfOneFrameSaysSo) {
  const Arm arm;
  const std::vector<Pose> one = {arm.pose(rest_angles(arm.limits), 2, {0, 1, 0}, -50)};
  const std::vector<HeldTurn> held = arm.held(one);
  ASSERT_EQ(held.size(), 1u);
  EXPECT_NEAR(held[0].degrees, 50, 1e-3);
  EXPECT_NE(describe(held[0], arm.skeleton, 1).find("50 degrees about the vertical axis beyond its limits in the only"),
            std::string::npos);
}

TEST(HeldTurns, JointsWithoutLimitsAreNamedNotJudged) {
  const Arm arm;
  std::vector<Pose> poses = {bind_pose(arm.skeleton), arm.pose(rest_angles(arm.limits), 3, {1, 0, 0}, 90)};
  poses[1].joints[0].rotation = axis_angle({0, 1, 0}, 1);  // the root goes where it likes
  EXPECT_TRUE(arm.held(poses).empty());
  EXPECT_EQ(turning_without_limits(arm.limits, arm.skeleton, poses), std::vector<std::string>{"hand"});
  poses.pop_back();
  EXPECT_TRUE(turning_without_limits(arm.limits, arm.skeleton, poses).empty());
}

// A performance that was retargeted badly, and the same read from its BVH.
TEST(HeldTurns, TheBadRealClipIsFoundAndTheGoodOneHardly) {
  const auto human = shared_data("characters/human_muscular.glb"), good = shared_data("motion/01_01.bvh");
  if (!human || !good) GTEST_SKIP() << kNeedsRealMotion;
  const Skeleton skeleton = read_character(*human).skeleton;
  const JointLimits limits = read_joint_limits(kSourceFolder + "/rigs/human/limits.json", skeleton);
  const auto names = [&](const std::string& source) {
    std::vector<std::string> found;
    for (const HeldTurn& turn : held_turns(limits, skeleton, read_clip(source, skeleton, {}).poses)) {
      found.push_back(skeleton.joints[turn.joint].name);
    }
    return found;
  };
  const std::vector<std::string> arms_and_thumbs = {"LeftArm",  "LeftHand",  "LThumb", "LeftFingerBase",
                                                    "RightArm", "RightHand", "RThumb", "RightFingerBase"};
  EXPECT_EQ(names(human->string() + "#cmu_01_01"), arms_and_thumbs);
  // Its wrists and a thumb are bent so in the file.
  EXPECT_EQ(names(good->string()), (std::vector<std::string>{"LeftFingerBase", "RThumb", "RightFingerBase"}));
}

}  // namespace held_turns_test
}  // namespace bodyopt::trainer
