// Feet that hang under the root for inverse kinematics: found by the skin, and carried along by a range of motion.
#include "trainer/motion/attached_rig.h"

#include <gtest/gtest.h>

#include <fstream>

#include "runtime/core/error.h"
#include "runtime/host/rig.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/detached_limb.h"
#include "tests/support/shared_data.h"
#include "tests/support/temporary_folder.h"
#include "trainer/motion/first_limits.h"
#include "trainer/motion/range_of_motion.h"

namespace bodyopt::trainer {
namespace {

std::vector<std::pair<std::string, std::string>> names(const std::vector<DetachedJoint>& detached,
                                                       const Skeleton& skeleton) {
  std::vector<std::pair<std::string, std::string>> result;
  for (const DetachedJoint& of : detached) {
    result.emplace_back(skeleton.joints[of.joint].name, skeleton.joints[of.follows].name);
  }
  return result;
}

using Names = std::vector<std::pair<std::string, std::string>>;

TEST(AttachedRig, FindsAFootUnderTheRootByItsSkin) {
  const Character character = detached_limb();
  EXPECT_EQ(names(detached_joints(character), character.skeleton), (Names{{"joint2", "joint1"}}));
  EXPECT_TRUE(detached_joints(limb_character()).empty());
}

// Also where it hangs under nothing at all.
TEST(AttachedRig, FindsAFootWithoutAParent) {
  Character character = detached_limb();
  character.skeleton.joints[1].parent = -1;
  EXPECT_EQ(names(detached_joints(character), character.skeleton), (Names{{"joint2", "joint1"}}));
}

TEST(AttachedRig, AMirroredFootFollowsItsOwnLeg) {
  Skeleton skeleton;
  for (const char* name : {"root", "LeftLeg", "RightLeg", "LeftFoot", "RightFoot"}) {
    Joint joint;
    joint.name = name;
    joint.parent = skeleton.joints.empty() ? -1 : 0;
    skeleton.joints.push_back(joint);
  }
  const TemporaryFolder folder;
  std::ofstream(folder / "limits.json") << R"({"schema": "bodyopt-joint-limits-1", "mirrored_joints":
    [{"joint": "LeftLeg", "mirror": "RightLeg"}, {"joint": "LeftFoot", "mirror": "RightFoot"}],
    "dofs": [{"name": "a", "rest": 0, "min": 0, "max": 9, "turns": [{"joint": "LeftLeg", "axis": [1, 0, 0]}]}],
    "detached_joints": [{"joint": "RightFoot", "follows": "RightLeg"}]})";
  EXPECT_EQ(names(read_joint_limits(folder / "limits.json", skeleton).detached, skeleton),
            (Names{{"RightFoot", "RightLeg"}, {"LeftFoot", "LeftLeg"}}));
}

TEST(AttachedRig, OfRealBodiesOnlyThoseMadeForInverseKinematics) {
  if (!shared_data("characters/human_heavy.glb")) GTEST_SKIP() << kNeedsRealBodies;
  const auto found = [](const std::string& name, double unit) {
    const Character character = read_character(*shared_data("characters/" + name + ".glb"), unit);
    return names(detached_joints(character), character.skeleton);
  };
  EXPECT_EQ(found("quaternius_trex", 0.4), (Names{{"BackFoot.R", "BackLowLeg.R"}, {"BackFoot.L", "BackLowLeg.L"}}));
  EXPECT_EQ(found("quaternius_horse", 0.25), (Names{{"FrontFoot.R", "FrontLowLeg.R"},
                                                    {"BackFoot.R", "BackLowLeg.R"},
                                                    {"FrontFoot.L", "FrontLowLeg.L"},
                                                    {"BackFoot.L", "BackLowLeg.L"}}));
  for (const auto& [name, unit] : std::vector<std::pair<std::string, double>>{
           {"human_heavy", 1}, {"human_163_joints", 1}, {"greenman", 1}, {"fox", 0.01}, {"cesium_man", 1}}) {
    EXPECT_TRUE(found(name, unit).empty()) << name;
  }
}

// Of whatever pose, and back, and the same places of all joints.
TEST(AttachedRig, MovesAsTheCharactersOwn) {
  Character character = detached_limb();
  character.skeleton.joints[0].bind.scale = {100, 100, 100};
  const AttachedRig rig(character.skeleton, detached_joints(character));
  Pose pose = bind_pose(character.skeleton);
  pose.joints[1] = {{0.1, 0.2, 0.4}, axis_angle({0.6, 0.8, 0}, 0.7)};
  pose.joints[2].rotation = axis_angle({1, 0, 0}, 0.5);
  pose.joints[3].rotation = axis_angle({0, 1, 0}, -0.9);
  pose.unmodified = pose.joints;
  pose.unmodified[1].translation = {0.3, 0.2, 0.4};
  const Pose attached = rig.attached(pose), back = rig.detached(attached);
  const std::vector<Affine> own = posed_joints(character.skeleton, pose.joints),
                            world = posed_joints(rig.skeleton(), attached.joints),
                            again = posed_joints(character.skeleton, back.joints);
  ASSERT_EQ(back.unmodified.size(), pose.unmodified.size());
  const std::vector<Affine> unmodified = posed_joints(character.skeleton, back.unmodified),
                            own_unmodified = posed_joints(character.skeleton, pose.unmodified);
  EXPECT_NEAR(unmodified[1].m[0][3], own_unmodified[1].m[0][3], 1e-12);
  for (std::size_t j = 0; j < character.skeleton.size(); ++j) {
    const auto k = static_cast<std::size_t>(rig.skeleton().find(character.skeleton.joints[j].name));
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) {
        EXPECT_NEAR(world[k].m[row][column], own[j].m[row][column], 1e-12) << j;
        EXPECT_NEAR(again[j].m[row][column], own[j].m[row][column], 1e-12) << j;
      }
    }
  }
}

TEST(AttachedRig, ARangeOfMotionKeepsTheFootAtItsLeg) {
  const Character own = detached_limb();
  const JointLimits own_limits = first_limits(own, {});
  ASSERT_EQ(own_limits.detached.size(), 1u);
  const TemporaryFolder folder;
  write_joint_limits(own_limits, own.skeleton, folder / "limits.json");
  const JointLimits read = read_joint_limits(folder / "limits.json", own.skeleton);
  EXPECT_EQ(names(read.detached, own.skeleton), (Names{{"joint2", "joint1"}}));

  const AttachedRig rig(own.skeleton, read.detached);
  const JointLimits limits = rig.attached(read);
  const Character character = rig.attached(own);
  const Clip clip = rig.detached(clip_of(range_of_motion(character, limits, {60, 3, {}}), limits, character.skeleton));
  double farthest = 0;
  for (const Pose& pose : clip.poses) {
    const std::vector<Affine> world = posed_joints(own.skeleton, pose.joints);
    const Vec3 foot = world[1] * Vec3{0, 0, 0}, end = world[3] * Vec3{0, 0, 0.2};
    EXPECT_LT(length(foot - end), 1e-9);
    farthest = std::max(farthest, length(foot - Vec3{0, 0, 0.5}));
  }
  EXPECT_GT(farthest, 0.02);
}

TEST(AttachedRig, JointsThatFollowEachOtherAreRefused) {
  const Skeleton skeleton = detached_limb().skeleton;
  EXPECT_THROW(AttachedRig(skeleton, {{1, 1}}), Error);
  EXPECT_THROW(AttachedRig(skeleton, {{2, 3}}), Error);
  Skeleton sheared = skeleton;
  sheared.joints[2].bind.scale = {1, 2, 1};
  sheared.joints[1].bind.rotation = axis_angle({1, 0, 0}, 0.8);
  EXPECT_THROW(AttachedRig(sheared, {{1, 3}}), Error);
  const TemporaryFolder folder;
  JointLimits limits = first_limits(detached_limb(), {});
  for (const DetachedJoint& wrong : {DetachedJoint{2, 3}, DetachedJoint{3, 1}}) {  // the tip follows the elbow
    limits.detached.push_back(wrong);
    write_joint_limits(limits, skeleton, folder / "limits.json");
    limits.detached.pop_back();
    try {
      read_joint_limits(folder / "limits.json", skeleton);
      ADD_FAILURE() << skeleton.joints[wrong.joint].name;
    } catch (const Error& error) {
      const std::string expected = "limits.json: detached_joints[1] lets '" + skeleton.joints[wrong.joint].name + "'";
      EXPECT_NE(std::string(error.what()).find(expected), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace bodyopt::trainer
