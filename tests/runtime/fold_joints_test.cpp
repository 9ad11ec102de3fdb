#include <gtest/gtest.h>

#include "runtime/host/skin_tables.h"

namespace bodyopt::testing {
namespace fold_joints_test {

// A body that stands: hips, a spine of two bones, legs and arms of two each, a hand with two fingers, a head.
struct Body {
  std::uint32_t add(int parent, const Vec3& place) {
    Joint joint;
    joint.parent = parent;
    joint.inverse_bind = inverse(affine_from({.translation = place}));
    skeleton.joints.push_back(joint);
    return static_cast<std::uint32_t>(skeleton.size() - 1);
  }
  std::uint32_t add(std::uint32_t parent, const Vec3& place) { return add(static_cast<int>(parent), place); }

  Skeleton skeleton;
  const std::uint32_t hips = add(-1, {0, 1, 0}), spine = add(hips, {0, 1.2, 0}), chest = add(spine, {0, 1.4, 0}),
                      left_thigh = add(hips, {0.1, 1, 0}), left_shin = add(left_thigh, {0.1, 0.5, 0}),
                      left_foot = add(left_shin, {0.1, 0, 0}), right_thigh = add(hips, {-0.1, 1, 0}),
                      right_foot = add(right_thigh, {-0.1, 0, 0}), collar = add(chest, {0.05, 1.4, 0}),
                      arm = add(collar, {0.2, 1.4, 0}), forearm = add(arm, {0.5, 1.4, 0}),
                      hand = add(forearm, {0.8, 1.4, 0}), finger = add(hand, {0.9, 1.4, 0}),
                      thumb = add(hand, {0.85, 1.4, 0}), right_arm = add(chest, {-0.2, 1.4, 0}),
                      right_hand = add(right_arm, {-0.8, 1.4, 0}), head = add(chest, {0, 1.6, 0}),
                      another_root = add(-1, {0.2, 1.4, 0});
};

TEST(FoldJoints, TheTrunkCarriesLimbs) {
  const Body body;
  std::vector<char> expected(body.skeleton.size(), 0);
  for (const std::uint32_t joint : {body.hips, body.spine, body.chest}) expected[joint] = 1;
  EXPECT_EQ(trunk_joints(body.skeleton), expected);  // a hand with fingers, or a chest's neck, is no more of it
}

TEST(FoldJoints, AnArmpitClosesOnTheTrunkNearIt) {
  const Body body;
  constexpr float kReach = 0.55f;
  const std::vector<float> reaches = fold_reaches(body.skeleton, body.arm, kReach);
  for (const std::uint32_t joint : {body.collar, body.arm}) EXPECT_EQ(reaches[joint], kReach) << joint;
  for (const std::uint32_t joint : {body.hips, body.spine, body.chest, body.forearm}) {
    EXPECT_FLOAT_EQ(reaches[joint], 0.625f * kReach) << joint;
  }
  for (const std::uint32_t joint : {body.left_thigh, body.left_foot, body.right_hand, body.hand, body.another_root}) {
    EXPECT_EQ(reaches[joint], 0) << joint;
  }
}

TEST(FoldJoints, AnElbowDoesNotCloseOnTheTrunk) {
  const Body body;
  const std::vector<float> reaches = fold_reaches(body.skeleton, body.forearm, 0.6f);
  EXPECT_EQ(reaches[body.arm], 0.6f);
  EXPECT_EQ(reaches[body.collar], 0.6f);
  EXPECT_EQ(reaches[body.hand], 0.6f);  // which is near, and away from the trunk
  EXPECT_EQ(reaches[body.chest], 0);    // 0.5 along the bones
  EXPECT_EQ(reaches[body.left_thigh], 0);
}

TEST(FoldJoints, WhatAJointBendsIsItsFoldsWhereverItStands) {
  const Body body;
  EXPECT_EQ(fold_reaches(body.skeleton, body.left_thigh, 0.05f)[body.hips], 0.05f);  // of the trunk
  EXPECT_EQ(fold_reaches(body.skeleton, body.left_shin, 0.1f)[body.left_thigh], 0.1f);
}

// A back folds on itself, and on limbs beside it.
TEST(FoldJoints, TheTrunksOwnFoldsReachAlongTheBones) {
  const Body body;
  const std::vector<float> reaches = fold_reaches(body.skeleton, body.chest, 0.45f);
  for (const std::uint32_t joint : {body.hips, body.spine, body.chest, body.collar, body.arm, body.head}) {
    EXPECT_EQ(reaches[joint], 0.45f) << joint;
  }
  EXPECT_EQ(reaches[body.left_thigh], 0);
  EXPECT_EQ(reaches[body.forearm], 0);
}

TEST(FoldJoints, WhatHangsBelowAJoint) {
  const Body body;
  std::vector<char> expected(body.skeleton.size(), 0);
  for (const std::uint32_t joint : {body.forearm, body.hand, body.finger, body.thumb}) expected[joint] = 1;
  EXPECT_EQ(at_or_below(body.skeleton, body.forearm), expected);
}

}  // namespace fold_joints_test
}  // namespace bodyopt::testing
