// The built-in character's motions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "runtime/core/error.h"
#include "runtime/host/rig.h"
#include "tests/builtin/shared_arm.h"
#include "trainer/motion/range_of_motion.h"

namespace bodyopt::trainer {
namespace {

const Skeleton& skeleton() { return arm().character.skeleton; }

const JointLimits& limits() {
  static const JointLimits built = arm_limits(skeleton());
  return built;
}

Clip range_of_motion_clip(int frames, std::uint64_t seed) {
  return clip_of(range_of_motion(arm().character, limits(), {.frames = frames, .seed = seed}), limits(), skeleton());
}

// Degrees between two poses of one joint.
double angle_between(const JointTransform& a, const JointTransform& b) {
  const Quat q = conjugate(a.rotation) * b.rotation;
  return 2 * std::atan2(std::hypot(q[0], std::hypot(q[1], q[2])), std::abs(q[3])) * 180 / M_PI;
}

double largest_angle(const Pose& a, const Pose& b) {
  double most = 0;
  for (std::size_t j = 0; j < a.joints.size(); ++j) most = std::max(most, angle_between(a.joints[j], b.joints[j]));
  return most;
}

// Largest angle that a joint may reach away from rest, by the table of limits.
double reach(const std::string& joint) {
  const auto span = [](ArmDof dof) {
    const DegreeOfFreedom& of = limits().dofs[dof];
    return std::max(of.max - of.rest, of.rest - of.min);
  };
  if (joint == "clavicle") return span(kClavicleElevation) + span(kClavicleProtraction);
  if (joint == "shoulder") {
    return span(kShoulderAbduction) + span(kShoulderFlexion) + span(kShoulderRotation);
  }
  if (joint == "elbow") return span(kElbowFlexion);
  if (joint == "forearm" || joint == "forearm_twist") return 0.5 * span(kForearmTwist);
  if (joint == "wrist") return span(kWristFlexion) + span(kWristDeviation);
  if (joint == "torso") return 0;
  return 1.1 * span(kFingerCurl);
}

TEST(ArmAngles, AreThoseOfTheLimits) {
  ASSERT_EQ(limits().dofs.size(), static_cast<std::size_t>(kArmDofCount));
  EXPECT_EQ(limits().dofs[kClavicleElevation].name, "clavicle_elevation");
  EXPECT_EQ(limits().dofs[kClavicleProtraction].name, "clavicle_protraction");
  EXPECT_EQ(limits().dofs[kShoulderAbduction].name, "shoulder_abduction");
  EXPECT_EQ(limits().dofs[kShoulderFlexion].name, "shoulder_flexion");
  EXPECT_EQ(limits().dofs[kShoulderRotation].name, "shoulder_rotation");
  EXPECT_EQ(limits().dofs[kElbowFlexion].name, "elbow_flexion");
  EXPECT_EQ(limits().dofs[kForearmTwist].name, "forearm_twist");
  EXPECT_EQ(limits().dofs[kWristFlexion].name, "wrist_flexion");
  EXPECT_EQ(limits().dofs[kWristDeviation].name, "wrist_deviation");
  EXPECT_EQ(limits().dofs[kFingerCurl].name, "finger_curl");
}

TEST(ArmAngles, RestAnglesAreTheBindPose) {
  const Angles rest = rest_angles(limits());
  EXPECT_NEAR(largest_angle(limited_pose(skeleton(), limits(), {rest}), bind_pose(skeleton())), 0, 1e-12);
}

TEST(ArmAngles, MoveTheRightWay) {
  const auto joint_at = [](const char* joint, ArmDof dof, double degrees) {
    Angles angles = rest_angles(limits());
    angles[dof] = degrees;
    const Affine at =
        posed_joints(skeleton(), limited_pose(skeleton(), limits(), {angles}).joints)[skeleton().find(joint)];
    return Vec3{at.m[0][3], at.m[1][3], at.m[2][3]};
  };
  EXPECT_GT(joint_at("shoulder", kClavicleElevation, 20)[1], joint_at("shoulder", kClavicleElevation, 0)[1] + 0.02);
  EXPECT_GT(joint_at("shoulder", kClavicleProtraction, 18)[2], joint_at("shoulder", kClavicleProtraction, 0)[2] + 0.02);
  EXPECT_GT(joint_at("elbow", kShoulderAbduction, 90)[1], joint_at("elbow", kShoulderAbduction, 50)[1] + 0.1);
  EXPECT_NEAR(joint_at("elbow", kShoulderAbduction, 90)[1], joint_at("shoulder", kShoulderAbduction, 90)[1], 1e-9);
  EXPECT_GT(joint_at("elbow", kShoulderFlexion, 60)[2], joint_at("elbow", kShoulderFlexion, 0)[2] + 0.2);
  EXPECT_GT(joint_at("wrist", kShoulderRotation, 50)[0], joint_at("wrist", kShoulderRotation, 0)[0] + 0.02);
  const double bent = length(joint_at("wrist", kElbowFlexion, 130) - joint_at("shoulder", kElbowFlexion, 130));
  const double straight = length(joint_at("wrist", kElbowFlexion, 0) - joint_at("shoulder", kElbowFlexion, 0));
  EXPECT_LT(bent, 0.26);
  EXPECT_NEAR(straight, 0.567, 1e-3);
}

TEST(Heldout, SharesNoPoseWithTheRangeOfMotion) {
  const Clip heldout = arm_heldout(skeleton(), kArmHeldoutFrames);
  for (const std::uint64_t seed : {0u, 1u, 2u, 42u}) {
    const Clip training = range_of_motion_clip(480, seed);
    double nearest = 180;
    for (const Pose& held : heldout.poses) {
      for (const Pose& pose : training.poses) nearest = std::min(nearest, largest_angle(held, pose));
    }
    EXPECT_GT(nearest, 3) << "seed " << seed;
  }
}

TEST(Heldout, TakesAnyLengthUpToItsOwn) {
  for (const int count : {1, 2, 20, 75, kArmHeldoutFrames}) {
    EXPECT_EQ(arm_heldout(skeleton(), count).poses.size(), static_cast<std::size_t>(count));
  }
  EXPECT_THROW(arm_heldout(skeleton(), 0), Error);
  EXPECT_THROW(arm_heldout(skeleton(), kArmHeldoutFrames + 1), Error);
  EXPECT_THROW(arm_heldout(Skeleton{}, 10), Error);
}

TEST(Heldout, OfFewerFramesIsTheSameMotion) {
  const Clip all = arm_heldout(skeleton(), kArmHeldoutFrames), few = arm_heldout(skeleton(), kArmHeldoutFrames / 6);
  EXPECT_EQ(few.fps, 24);
  for (std::size_t k = 0; k < few.poses.size(); ++k) {
    EXPECT_NEAR(largest_angle(few.poses[k], all.poses[6 * k]), 0, 1e-3) << "frame " << k;
  }
}

TEST(Heldout, MovesSmoothlyWithinLimits) {
  const Clip clip = arm_heldout(skeleton(), kArmHeldoutFrames);  // at 24 frames a second
  EXPECT_EQ(clip.fps, 24);
  std::vector<double> most(skeleton().size());
  for (std::size_t k = 0; k < clip.poses.size(); ++k) {
    for (std::size_t j = 0; j < skeleton().size(); ++j) {
      const double away = angle_between(clip.poses[k].joints[j], skeleton().joints[j].bind);
      most[j] = std::max(most[j], away);
      ASSERT_LE(away, reach(skeleton().joints[j].name) + 1e-6);
      if (k == 0) continue;
      ASSERT_LT(angle_between(clip.poses[k].joints[j], clip.poses[k - 1].joints[j]), 30) << "frame " << k;
    }
  }
  EXPECT_GT(most[skeleton().find("shoulder")], 60);
  EXPECT_GT(most[skeleton().find("elbow")], 95);
  EXPECT_GT(most[skeleton().find("forearm")], 30);
  EXPECT_GT(most[skeleton().find("wrist")], 25);
}

Vec3 joint_position(const Pose& pose, const char* joint) {
  const Affine at = posed_joints(skeleton(), pose.joints)[skeleton().find(joint)];
  return {at.m[0][3], at.m[1][3], at.m[2][3]};
}

TEST(Stop, IsHeldThenAsFastAsAVigorousArmThenHeld) {
  const Clip clip = arm_stop(skeleton());
  ASSERT_EQ(clip.fps, 24);
  ASSERT_EQ(clip.first_frame, 1);
  ASSERT_GE(clip.poses.size(), static_cast<std::size_t>(kStopEnds + 36));  // a second and a half
  std::vector<double> speed(clip.poses.size());                            // of the fingers, m/s
  for (std::size_t k = 1; k < clip.poses.size(); ++k) {
    speed[k] =
        24 * length(joint_position(clip.poses[k], "fingertips") - joint_position(clip.poses[k - 1], "fingertips"));
    const bool moves = k >= kStopBegins && k < kStopEnds;
    EXPECT_EQ(speed[k] > 1e-3, moves) << "frame " << k + 1;
    for (std::size_t j = 0; !moves && j < skeleton().size(); ++j) {
      EXPECT_NEAR(angle_between(clip.poses[k].joints[j], clip.poses[k - 1].joints[j]), 0, 1e-5) << "frame " << k + 1;
    }
  }
  const double peak = *std::max_element(speed.begin(), speed.end());
  EXPECT_GT(peak, 4);
  EXPECT_LT(peak, 6);
  EXPECT_EQ(speed[kStopEnds - 2], peak);  // full speed until two frames before the end
  EXPECT_LT(speed[kStopEnds - 1], 0.5 * peak);
  EXPECT_THROW(arm_stop(Skeleton{}), Error);
}

// Read back from the pose itself: bones of the limb as lines, the torso as the ellipse of its ribs.
double deepest_in_ribs(const Pose& pose) {
  const std::vector<Affine> joints = posed_joints(skeleton(), pose.joints);
  double deepest = 0;
  for (const char* end : {"wrist", "fingers", "fingertips"}) {
    const Affine& to = joints[skeleton().find(end)];
    const Affine& from = joints[skeleton().joints[skeleton().find(end)].parent];
    for (const double t : {0.0, 0.5, 1.0}) {
      Vec3 p;
      for (int i = 0; i < 3; ++i) p[i] = (1 - t) * from.m[i][3] + t * to.m[i][3];
      p[1] -= pose.joints[0].translation[1] - bind_pose(skeleton()).joints[0].translation[1];  // as the torso stands
      if (p[1] < 1.10 || p[1] > 1.40) continue;
      deepest = std::max(deepest, 1 - std::hypot(p[0] / 0.150, p[2] / 0.110));
    }
  }
  return deepest;
}

TEST(Motions, KeepForearmAndHandOutOfTheRibs) {
  for (const Pose& pose : arm_heldout(skeleton(), kArmHeldoutFrames).poses) EXPECT_EQ(deepest_in_ribs(pose), 0);
  for (const Pose& pose : arm_stop(skeleton()).poses) EXPECT_EQ(deepest_in_ribs(pose), 0);
  for (const Pose& pose : range_of_motion_clip(480, 5).poses) EXPECT_EQ(deepest_in_ribs(pose), 0);
}

}  // namespace
}  // namespace bodyopt::trainer
