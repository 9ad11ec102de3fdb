#include "runtime/host/rig.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

// A chain of joints with arbitrary bind rotations, bent by a seeded random pose.
Skeleton random_chain(std::mt19937_64& random, int count) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Skeleton skeleton;
  Affine world;
  for (int j = 0; j < count; ++j) {
    Joint joint;
    joint.name = "joint" + std::to_string(j);
    joint.parent = j - 1;
    joint.bind.translation = {0.1 * uniform(random), 0.3, 0.1 * uniform(random)};
    joint.bind.rotation = normalized({uniform(random), uniform(random), uniform(random), uniform(random)});
    joint.default_local = joint.bind;
    world = world * affine_from(joint.bind);
    joint.inverse_bind = inverse(world);
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

Pose random_pose(const Skeleton& skeleton, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Pose pose = bind_pose(skeleton);
  for (JointTransform& t : pose.joints) {
    t.rotation = normalized({uniform(random), uniform(random), uniform(random), 1 + uniform(random)});
  }
  return pose;
}

TEST(Rig, BindPoseGivesIdentityMatrices) {
  std::mt19937_64 random(1);
  const Skeleton skeleton = random_chain(random, 5);
  for (const Affine& m : skinning_matrices(skeleton, bind_pose(skeleton).joints)) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 4; ++j) EXPECT_NEAR(m.m[i][j], i == j ? 1 : 0, 1e-12);
    }
  }
  for (const float f : pose_rig(skeleton, bind_pose(skeleton)).joint_features) EXPECT_NEAR(f, 0, 1e-7);
}

TEST(Rig, FeaturesAreTheRotationAwayFromBindInRestAxes) {
  std::mt19937_64 random(2);
  const Skeleton skeleton = random_chain(random, 4);
  const Pose pose = random_pose(skeleton, random);
  const RigFrame frame = pose_rig(skeleton, pose);
  // Textbook: with world rotations G, the skinning rotation of j away from that of its parent is
  // (parent's skinning)^-1 (own skinning), both being rotations of rest space.
  const auto skinning = skinning_matrices(skeleton, pose.joints);
  for (std::size_t j = 1; j < 4; ++j) {
    const Affine relative = inverse(skinning[j - 1]) * skinning[j];
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(frame.joint_features[9 * (j - 1) + static_cast<std::size_t>(3 * i + k)],
                    relative.m[i][k] - (i == k ? 1 : 0), 1e-6);
      }
    }
  }
}

// Features of a carried basis: by world rotations, of a joint relative to one three above it.
TEST(Rig, CarriedFeaturesAreThoseOfAChainInOtherAxes) {
  std::mt19937_64 random(5);
  Skeleton skeleton = random_chain(random, 5);
  const Pose pose = random_pose(skeleton, random);
  const Quat above = normalized({0.2, -0.1, 0.4, 0.9}), own = normalized({-0.3, 0.5, 0.1, 0.8});
  skeleton.features = {{4, 1, above, own}, {2, 2}};
  EXPECT_EQ(joint_feature_count(skeleton), 18u);
  EXPECT_EQ(feature_joints(skeleton), (std::vector<std::uint32_t>{4, 2}));
  const std::vector<float> features = pose_rig(skeleton, pose).joint_features;
  const auto world = posed_joints(skeleton, pose.joints);
  const std::vector<Quat> bind = bind_rotations(skeleton);
  const auto away = [&](std::size_t j) { return decompose(world[j]).rotation * conjugate(bind[j]); };
  const Quat whole = normalized(above * conjugate(away(1)) * away(4) * conjugate(own));
  for (std::size_t k = 0; k < 9; ++k) {
    const double rest = k % 4 == 0 ? 1 : 0;
    EXPECT_NEAR(features[k], rotation_matrix(whole)[k / 3][k % 3] - rest, 1e-6);
    EXPECT_EQ(features[9 + k], 0);
  }
}

TEST(Rig, TurningTheRootChangesNoFeatureBit) {
  std::mt19937_64 random(3);
  const Skeleton skeleton = random_chain(random, 6);
  Pose pose = random_pose(skeleton, random);
  const std::vector<float> before = pose_rig(skeleton, pose).joint_features;
  pose.joints[0].rotation = axis_angle({1, 2, -3}, 2.1) * pose.joints[0].rotation;
  pose.joints[0].translation = {100, -50, 70};
  EXPECT_EQ(before, pose_rig(skeleton, pose).joint_features);
}

// A foot beside its leg: by world rotations, relative to a joint that it does not hang under.
TEST(Rig, FeaturesOfADetachedJointAreSeenFromItsLimb) {
  std::mt19937_64 random(6);
  Skeleton skeleton = random_chain(random, 5);
  skeleton.joints[4].parent = 1;
  skeleton.joints[4].inverse_bind =
      inverse(inverse(skeleton.joints[1].inverse_bind) * affine_from(skeleton.joints[4].bind));
  skeleton.features = {{4, 3}, {3, 4}};
  EXPECT_EQ(common_joint(skeleton, 4, 3), 1);
  const Pose pose = random_pose(skeleton, random);
  const std::vector<float> features = pose_rig(skeleton, pose).joint_features;
  const auto world = posed_joints(skeleton, pose.joints);
  const std::vector<Quat> bind = bind_rotations(skeleton);
  const auto away = [&](std::size_t j) { return decompose(world[j]).rotation * conjugate(bind[j]); };
  const auto expected = rotation_matrix(normalized(conjugate(away(3)) * away(4)));
  for (std::size_t k = 0; k < 9; ++k) {
    EXPECT_NEAR(features[k], expected[k / 3][k % 3] - (k % 4 == 0 ? 1 : 0), 1e-6);
    EXPECT_NEAR(features[9 + k], expected[k % 3][k / 3] - (k % 4 == 0 ? 1 : 0), 1e-6);
  }
}

// By matrices: where the joint would stand, were the other at rest.
TEST(Rig, FeaturesOfAJointThatSlidesAreItsPlace) {
  std::mt19937_64 random(7);
  Skeleton skeleton = random_chain(random, 4);
  const Quat axes = normalized({0.2, -0.1, 0.4, 0.9});
  skeleton.features = {{3, 2, axes, {0, 0, 0, 1}, 5}, {3, 1, {0, 0, 0, 1}, {0, 0, 0, 1}, 2}, {2, 2, {}, {}, 5}};
  Pose pose = random_pose(skeleton, random);
  pose.joints[3].translation = pose.joints[3].translation + Vec3{0.04, -0.03, 0.02};
  const std::vector<float> features = pose_rig(skeleton, pose).joint_features;
  const auto world = posed_joints(skeleton, pose.joints);
  const auto slide = [&](std::size_t above) {
    const Affine unposed = inverse(skeleton.joints[above].inverse_bind) * inverse(world[above]) * world[3];
    return Vec3{unposed.m[0][3], unposed.m[1][3], unposed.m[2][3]} - bind_place(skeleton, 3);
  };
  const Vec3 own = rotate(axes, slide(2)), other = slide(1);
  EXPECT_NEAR(length(own), std::sqrt(0.0029), 1e-12);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(features[k], 5 * own[k], 1e-6);
    EXPECT_NEAR(features[9 + k], 2 * other[k], 1e-6);
  }
  for (std::size_t k = 3; k < 9; ++k) EXPECT_EQ(features[k], 0);
  for (std::size_t k = 18; k < 27; ++k) EXPECT_EQ(features[k], 0);
}

TEST(Rig, OriginIsTakenOutOfTheMatrices) {
  std::mt19937_64 random(4);
  const Skeleton skeleton = random_chain(random, 3);
  Pose pose = random_pose(skeleton, random);
  const RigFrame near = pose_rig(skeleton, pose);
  for (int i = 0; i < 3; ++i) pose.joints[0].translation[static_cast<std::size_t>(i)] += 1000;
  const RigFrame far = pose_rig(skeleton, pose);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(far.origin[i] - near.origin[i], 1000, 1e-3);
  for (std::size_t k = 0; k < near.skinning.size(); ++k) EXPECT_NEAR(near.skinning[k], far.skinning[k], 1e-4);
}

TEST(Rig, RefusesPosesThatDoNotFit) {
  std::mt19937_64 random(5);
  const Skeleton skeleton = random_chain(random, 3);
  Pose pose = bind_pose(skeleton);
  pose.joints.pop_back();
  EXPECT_THROW(pose_rig(skeleton, pose), Error);
  pose = bind_pose(skeleton);
  pose.joints[1].rotation[2] = std::nan("");
  EXPECT_THROW(pose_rig(skeleton, pose), Error);
  pose = bind_pose(skeleton);
  pose.joints[1].rotation = {0, 0, 0, 0};
  EXPECT_THROW(pose_rig(skeleton, pose), Error);
  pose.joints[1].rotation = {0, 0, 0, -0.5};  // any length is one rotation
  EXPECT_NO_THROW(pose_rig(skeleton, pose));
}

}  // namespace
}  // namespace bodyopt
