// First limits: what clips show, rules where they show nothing, and what is written of them.
#include "trainer/motion/first_limits.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "runtime/core/error.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/temporary_folder.h"
#include "trainer/motion/held_turns.h"

namespace bodyopt::trainer {
namespace {

// The limb's elbow bent by -20 to 90 degrees about x, and turned about its length by 30 while it is bent.
std::vector<Pose> elbow_poses() {
  std::vector<Pose> poses;
  const Skeleton skeleton = limb_skeleton();
  for (int k = 0; k <= 110; ++k) {
    Pose pose = bind_pose(skeleton);
    const double to_radians = std::numbers::pi / 180;
    pose.joints[1].rotation =
        axis_angle({1, 0, 0}, (k - 20) * to_radians) * axis_angle({0, 0, 1}, (k > 20 ? 30 : 0) * to_radians);
    poses.push_back(pose);
  }
  return poses;
}

TEST(FirstLimits, TakeWhatClipsShowAndRulesElsewhere) {
  const JointLimits limits = first_limits(limb_character(), elbow_poses());
  ASSERT_EQ(limits.dofs.size(), 6u);  // of the two joints below the root
  const auto expect = [&](std::size_t k, const char* name, double low, double high, const char* source) {
    EXPECT_EQ(limits.dofs[k].name, name);
    EXPECT_NEAR(limits.dofs[k].min, low, 0.11) << name;
    EXPECT_NEAR(limits.dofs[k].max, high, 0.11) << name;
    EXPECT_EQ(limits.dofs[k].rest, 0) << name;
    EXPECT_NE(limits.dofs[k].source.find(source), std::string::npos) << limits.dofs[k].source;
  };
  expect(0, "joint1 bend", -20 - 12, 90 + 12, "clips");
  expect(1, "joint1 side", -1, 1, "clips");
  expect(2, "joint1 twist", -4, 30 + 4, "clips");
  expect(3, "joint2 bend", -10, 10, "tip");
  expect(5, "joint2 twist", -5, 5, "tip");
}

// Angles of three axes, put together again, are the turn that they were read from.
TEST(FirstLimits, ReachEveryPoseTheyAreTakenFrom) {
  const Skeleton skeleton = limb_skeleton();
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> random(-0.4, 0.4);
  for (int k = 0; k < 20; ++k) {
    Pose pose = bind_pose(skeleton);
    pose.joints[1].rotation = normalized(Quat{random(engine), random(engine), random(engine), 1});
    const JointLimits limits = first_limits(limb_character(), {pose});
    Posture posture{rest_angles(limits)};
    for (std::size_t d = 0; d < 3; ++d) {  // the far end of a range of one pose, without what it is widened by
      const double low = limits.dofs[d].min, high = limits.dofs[d].max;
      const double range = (high - low - 2) / 1.2, more = 0.1 * range + 1;
      posture.angles[d] = high - more > -(low + more) ? high - more : low + more;
    }
    const Quat turn = turns_from_bind(skeleton, {limited_pose(skeleton, limits, posture)}, 1)[0];
    EXPECT_LT(angle_of(conjugate(turn) * turns_from_bind(skeleton, {pose}, 1)[0]), 0.5) << k;
  }
}

// A hinge whose own axis is neither left-right nor front-back: only its bend goes far.
TEST(FirstLimits, BendAboutWhatAHingeTurnsAbout) {
  const Skeleton skeleton = limb_skeleton();
  const Vec3 along = length_of_bone(skeleton, 1), bone = (1 / length(along)) * along;
  const Vec3 across = cross(bone, {0.3, 0.7, -0.5}), hinge = (1 / length(across)) * across;
  std::vector<Pose> poses;
  for (int k = 0; k <= 15; ++k) {
    Pose pose = bind_pose(skeleton);
    pose.joints[1].rotation = axis_angle(hinge, 10 * k * std::numbers::pi / 180);
    poses.push_back(pose);
  }
  const JointLimits limits = first_limits(limb_character(), poses);
  EXPECT_NEAR(std::abs(dot(limits.dofs[0].turns[0].axis, hinge)), 1, 1e-5);
  EXPECT_NEAR(limits.dofs[0].max - limits.dofs[0].min, 150 + 2 * 16, 0.3);
  EXPECT_NEAR(limits.dofs[1].max, 1, 0.11);
  EXPECT_NEAR(limits.dofs[2].max, 1, 0.11);
}

TEST(FirstLimits, SayWhereTheyCutARange) {
  Pose pose = bind_pose(limb_skeleton());
  pose.joints[1].rotation = axis_angle({1, 0, 0}, 168 * std::numbers::pi / 180);
  const JointLimits limits = first_limits(limb_character(), {pose});
  EXPECT_EQ(limits.dofs[0].max, 170);
  EXPECT_NE(limits.dofs[0].source.find("cut at 170 degrees"), std::string::npos) << limits.dofs[0].source;
  EXPECT_EQ(limits.dofs[1].source.find("cut"), std::string::npos) << limits.dofs[1].source;
}

// What turns all of the skin bends none of it.
TEST(FirstLimits, LeaveOutARootBelowTheRoot) {
  Character character = limb_character();
  for (auto& weights : character.weights) {
    for (JointWeight& weight : weights) weight.joint = std::max(weight.joint, 1u);
  }
  const JointLimits limits = first_limits(character, elbow_poses());
  ASSERT_EQ(limits.dofs.size(), 3u);
  EXPECT_EQ(limits.dofs[0].name, "joint2 bend");
}

TEST(FirstLimits, AreReadBackAsTheyAreWritten) {
  const TemporaryFolder folder;
  const JointLimits limits = first_limits(limb_character(), elbow_poses());
  write_joint_limits(limits, limb_skeleton(), folder / "limits.json");
  const JointLimits read = read_joint_limits(folder / "limits.json", limb_skeleton());
  ASSERT_EQ(read.dofs.size(), limits.dofs.size());
  for (std::size_t k = 0; k < read.dofs.size(); ++k) {
    EXPECT_EQ(read.dofs[k].source, limits.dofs[k].source);
    EXPECT_EQ(read.dofs[k].min, limits.dofs[k].min);
    EXPECT_NEAR(dot(read.dofs[k].turns[0].axis, limits.dofs[k].turns[0].axis), 1, 1e-12);
  }
  ASSERT_EQ(read.deviations.size(), limits.deviations.size());
  EXPECT_EQ(read.deviations[0].degrees, kUsualDeviation);
  EXPECT_EQ(read.deviations[1].degrees, 5);  // a quarter of 20
  EXPECT_FALSE(read.source.empty());
  EXPECT_EQ(read.source, limits.source);
  EXPECT_EQ(read.deviations[1].source, limits.deviations[1].source);
}

TEST(FirstLimits, RefuseASkinThatNoJointBelowTheRootMoves) {
  Character stiff = limb_character();
  for (auto& weights : stiff.weights) weights = {{0, 1}};
  EXPECT_THROW(first_limits(stiff, {}), Error);
}

}  // namespace
}  // namespace bodyopt::trainer
