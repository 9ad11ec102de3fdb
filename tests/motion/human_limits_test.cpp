// The limits of the shared human rig, on the real character.
#include <gtest/gtest.h>

#include "assets/characters/character.h"
#include "runtime/host/rig.h"
#include "tests/support/paths.h"
#include "tests/support/shared_data.h"
#include "trainer/motion/explore.h"
#include "trainer/motion/held_turns.h"

namespace bodyopt::trainer {
namespace {

class HumanLimits : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto path = shared_data("characters/human_muscular.glb");
    if (!path) GTEST_SKIP() << kNeedsRealBodies;
    skeleton_ = read_character(*path).skeleton;
    limits_ = read_joint_limits(kSourceFolder + "/rigs/human/limits.json", skeleton_);
  }

  // Where a joint goes when these degrees of freedom have these angles.
  Vec3 at(const char* joint, const std::vector<std::pair<const char*, double>>& moves) const {
    Angles angles = rest_angles(limits_);
    for (const auto& [name, degrees] : moves) {
      for (std::size_t k = 0; k < angles.size(); ++k) {
        if (limits_.dofs[k].name == name) angles[k] = degrees;
      }
    }
    const Pose pose = limited_pose(skeleton_, limits_, {angles});
    const Affine world = posed_joints(skeleton_, pose.joints)[static_cast<std::size_t>(skeleton_.find(joint))];
    return {world.m[0][3], world.m[1][3], world.m[2][3]};
  }

  Skeleton skeleton_;
  JointLimits limits_;
};

constexpr int kLeft = 0, kUp = 1, kForwards = 2;

TEST_F(HumanLimits, MoveTheBodyTheRightWay) {
  const auto moves = [&](const char* joint, const char* dof, double low, double high, int axis) {
    return at(joint, {{dof, high}})[axis] - at(joint, {{dof, low}})[axis];
  };
  EXPECT_GT(moves("Head", "spine_flexion", 0, 60, kForwards), 0.3);
  EXPECT_GT(moves("Head", "spine_lateral", -30, 30, kLeft), 0.2);
  EXPECT_LT(moves("LeftArm", "spine_rotation", 0, 45, kForwards), -0.05);
  EXPECT_GT(moves("LeftArm", "left_clavicle_elevation", -5, 25, kUp), 0.05);
  EXPECT_GT(moves("LeftArm", "left_clavicle_protraction", -15, 20, kForwards), 0.05);
  EXPECT_GT(moves("LeftForeArm", "left_shoulder_elevation", 41, 150, kUp), 0.3);
  EXPECT_GT(moves("LeftForeArm", "left_shoulder_plane", 0, 90, kForwards), 0.1);
  EXPECT_LT(moves("LeftHand", "left_shoulder_rotation", -60, 60, kLeft), -0.1);
  EXPECT_GT(moves("LeftHand", "left_elbow_flexion", 0, 120, kUp), 0.2);
  EXPECT_GT(moves("LeftHand", "left_elbow_flexion", 0, 90, kForwards), 0.15);
  EXPECT_GT(moves("LeftLeg", "left_hip_flexion", 5, 110, kForwards), 0.3);
  EXPECT_GT(moves("LeftLeg", "left_hip_flexion", 5, 110, kUp), 0.3);
  EXPECT_GT(moves("LeftLeg", "left_hip_abduction", -20, 40, kLeft), 0.3);
  EXPECT_LT(moves("LeftToeBase", "left_hip_rotation", -45, 45, kLeft), -0.1);
  EXPECT_LT(moves("LeftFoot", "left_knee_flexion", 6, 100, kForwards), -0.3);
  EXPECT_GT(moves("LeftFoot", "left_knee_flexion", 6, 100, kUp), 0.3);
  EXPECT_GT(moves("LeftToeBase", "left_ankle_dorsiflexion", -50, 20, kUp), 0.1);
}

// The straight arm and leg: angles that the rest pose counts as, measured on the joints.
TEST_F(HumanLimits, RestAnglesFitTheBindPose) {
  const auto direction = [&](const char* from, const char* to, const std::vector<std::pair<const char*, double>>& m) {
    const Vec3 d = at(to, m) - at(from, m);
    return (1 / length(d)) * d;
  };
  const std::vector<std::pair<const char*, double>> straight = {{"left_elbow_flexion", 0}, {"left_knee_flexion", 0}};
  EXPECT_GT(dot(direction("LeftArm", "LeftForeArm", straight), direction("LeftForeArm", "LeftHand", straight)),
            std::cos(0.02));
  EXPECT_GT(dot(direction("LeftUpLeg", "LeftLeg", straight), direction("LeftLeg", "LeftFoot", straight)),
            std::cos(0.03));
  const Vec3 arm = direction("LeftArm", "LeftForeArm", {});
  EXPECT_NEAR(std::acos(-arm[1]) * 180 / M_PI, 41, 0.5);
}

TEST_F(HumanLimits, LeftAndRightAreMirrorImages) {
  for (const DegreeOfFreedom& dof : limits_.dofs) {
    if (dof.name.rfind("left_", 0) != 0) continue;
    const std::string right = "right_" + dof.name.substr(5);
    for (const double angle : {dof.min, dof.max}) {
      for (const char* end : {"HandFinger1", "ToeBase"}) {
        std::string left_end = std::string("Left") + end, right_end = std::string("Right") + end;
        if (std::string(end) == "HandFinger1" && dof.name.find("thumb") != std::string::npos) {
          left_end = "LThumb";
          right_end = "RThumb";
        }
        const Vec3 l = at(left_end.c_str(), {{dof.name.c_str(), angle}});
        const Vec3 r = at(right_end.c_str(), {{right.c_str(), angle}});
        EXPECT_NEAR(l[0], -r[0], 1e-4) << dof.name;
        EXPECT_NEAR(l[1], r[1], 1e-4) << dof.name;
        EXPECT_NEAR(l[2], r[2], 1e-4) << dof.name;
      }
    }
  }
}

}  // namespace
}  // namespace bodyopt::trainer
