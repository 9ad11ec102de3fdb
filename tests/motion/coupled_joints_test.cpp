// Joints that turn only together, on a chain of three.
#include <gtest/gtest.h>

#include <random>

#include "trainer/motion/held_turns.h"

namespace bodyopt::trainer {
namespace {

Skeleton chain() {
  Skeleton skeleton;
  for (const char* name : {"root", "lower", "middle", "upper"}) {
    Joint joint;
    joint.name = name;
    joint.parent = static_cast<int>(skeleton.size()) - 1;
    joint.bind.rotation = axis_angle({0, 0.6, 0.8}, 0.3 * static_cast<double>(skeleton.size()));
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

// Lower and middle share a bend; `own` radians of the middle's are its own; the upper one goes its own way.
std::vector<Pose> poses(const Skeleton& skeleton, double own) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Pose> made;
  for (int k = 0; k < 200; ++k) {
    Pose& pose = made.emplace_back(bind_pose(skeleton));
    const auto turn = [&](std::size_t joint, const Vec3& axis, double angle) {
      pose.joints[joint].rotation = pose.joints[joint].rotation * axis_angle(axis, angle);
    };
    const double bend = 0.8 * uniform(random);
    turn(0, {1, 0, 0}, bend);  // of roots nobody asks
    turn(1, {1, 0, 0}, 0.6 * bend);
    turn(2, {0, 1, 0}, 0.4 * bend + own * uniform(random));
    turn(3, {0, 0, 1}, 0.5 * uniform(random));
  }
  return made;
}

TEST(CoupledJoints, ThoseThatShareATurnAreNamed) {
  const Skeleton skeleton = chain();
  const std::vector<CoupledJoints> coupled = coupled_joints(skeleton, poses(skeleton, 0));
  ASSERT_EQ(coupled.size(), 1u);
  EXPECT_EQ(coupled[0].joint, 2u);
  EXPECT_EQ(coupled[0].parent, 1u);
  EXPECT_GT(coupled[0].correlation, 0.99);
  EXPECT_LE(coupled[0].correlation, 1);
  const std::string text = describe(coupled, skeleton);
  EXPECT_NE(text.find("'middle' with 'lower'"), std::string::npos) << text;
  EXPECT_EQ(text.find("upper"), std::string::npos) << text;
}

TEST(CoupledJoints, ATurnOfItsOwnTellsThemApart) {
  const Skeleton skeleton = chain();
  EXPECT_TRUE(coupled_joints(skeleton, poses(skeleton, 0.3)).empty());
  EXPECT_EQ(describe({}, skeleton), "");
}

TEST(CoupledJoints, StillnessAndNothingAreNotCoupled) {
  const Skeleton skeleton = chain();
  EXPECT_TRUE(coupled_joints(skeleton, std::vector<Pose>(5, bind_pose(skeleton))).empty());
  EXPECT_TRUE(coupled_joints(skeleton, {}).empty());
}

}  // namespace
}  // namespace bodyopt::trainer
