// The built-in character's muscles.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <set>

#include "runtime/host/rig.h"
#include "tests/builtin/shared_arm.h"
#include "trainer/motion/held_turns.h"

namespace bodyopt::trainer {
namespace arm_muscles_test {

using Eigen::Vector3d;

const JointLimits& limits() {
  static const JointLimits built = arm_limits(arm().character.skeleton);
  return built;
}

// Generalised winding number of the skin (Van Oosterom and Strackee's solid angles): 1 inside, 0 outside.
double winding_number(const Vector3d& p) {
  const Character& c = arm().character;
  double angle = 0;
  for (Eigen::Index t = 0; t < c.triangles.rows(); ++t) {
    const Vector3d u = Vector3d(c.vertices.row(c.triangles(t, 0))) - p;
    const Vector3d v = Vector3d(c.vertices.row(c.triangles(t, 1))) - p;
    const Vector3d w = Vector3d(c.vertices.row(c.triangles(t, 2))) - p;
    const double a = u.norm(), b = v.norm(), d = w.norm();
    angle += 2 * std::atan2(u.dot(v.cross(w)), a * b * d + u.dot(v) * d + v.dot(w) * a + w.dot(u) * b);
  }
  return angle / (4 * M_PI);
}

double length_at(const Muscle& muscle, const Angles& angles) {
  const Skeleton& skeleton = arm().character.skeleton;
  const std::vector<Affine> skinning = skinning_matrices(skeleton, limited_pose(skeleton, limits(), {angles}).joints);
  double sum = 0;
  for (std::size_t k = 0; k + 1 < muscle.path.size(); ++k) {
    sum += length(skinning[muscle.path[k + 1].joint] * muscle.path[k + 1].position -
                  skinning[muscle.path[k].joint] * muscle.path[k].position);
  }
  return sum;
}

// Length over rest length, with one angle changed.
double stretch(const std::string& name, ArmDof dof, double degrees) {
  for (const Muscle& muscle : arm().muscles) {
    if (muscle.name != name) continue;
    Angles angles = rest_angles(limits());
    angles[dof] = degrees;
    return length_at(muscle, angles) / length_at(muscle, rest_angles(limits()));
  }
  ADD_FAILURE() << "no muscle " << name;
  return 1;
}

TEST(ArmMuscles, AreNamedBoundAndInsideTheSkin) {
  std::set<std::string> names;
  for (const Muscle& muscle : arm().muscles) {
    names.insert(muscle.name);
    EXPECT_GT(muscle.radius, 0.005);
    EXPECT_LT(muscle.radius, 0.03);
    ASSERT_GE(muscle.path.size(), 2u);
    EXPECT_NE(muscle.path.front().joint, muscle.path.back().joint) << muscle.name << " moves nothing";
    for (std::size_t k = 0; k + 1 < muscle.path.size(); ++k) {
      const Vector3d a(muscle.path[k].position.data()), b(muscle.path[k + 1].position.data());
      ASSERT_LT(muscle.path[k].joint, arm().character.skeleton.size());
      ASSERT_GT((b - a).norm(), 0.01) << muscle.name;
      for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0}) {
        EXPECT_NEAR(winding_number(a + t * (b - a)), 1, 1e-6) << muscle.name << " leaves the skin after point " << k;
      }
    }
  }
  EXPECT_EQ(names.size(), arm().muscles.size());
  for (const char* needed :
       {"deltoid_anterior", "deltoid_middle", "deltoid_posterior", "pectoralis_sternal", "latissimus", "biceps_long",
        "brachialis", "triceps_long", "wrist_flexors", "wrist_extensors"}) {
    EXPECT_TRUE(names.count(needed)) << needed;
  }
}

TEST(ArmMuscles, BelliesHardlyLeaveTheSkin) {
  // The deepest skin vertex within a belly's middle: how far the tube around the path sticks out there.
  for (const Muscle& muscle : arm().muscles) {
    double deepest = 0;
    for (std::size_t k = 1; k + 1 < muscle.path.size(); ++k) {
      const Vector3d via(muscle.path[k].position.data());
      const double gap = (arm().character.vertices.rowwise() - via.transpose()).rowwise().norm().minCoeff();
      deepest = std::max(deepest, muscle.radius - gap);
    }
    EXPECT_LT(deepest, 0.004) << muscle.name;
  }
}

TEST(ArmMuscles, ShortenWhenTheyPull) {
  EXPECT_LT(stretch("biceps_long", kElbowFlexion, 120), 0.92);
  EXPECT_LT(stretch("biceps_short", kElbowFlexion, 120), 0.92);
  EXPECT_LT(stretch("brachialis", kElbowFlexion, 120), 0.85);
  EXPECT_LT(stretch("brachioradialis", kElbowFlexion, 120), 0.95);
  EXPECT_GT(stretch("triceps_long", kElbowFlexion, 120), 1.05);
  EXPECT_GT(stretch("triceps_lateral", kElbowFlexion, 120), 1.05);
  EXPECT_GT(stretch("triceps_medial", kElbowFlexion, 120), 1.05);
  EXPECT_LT(stretch("deltoid_middle", kShoulderAbduction, 110), 0.95);
  EXPECT_GT(stretch("deltoid_middle", kShoulderAbduction, 20), 1.01);
  EXPECT_LT(stretch("deltoid_anterior", kShoulderFlexion, 70), 0.95);
  EXPECT_GT(stretch("deltoid_posterior", kShoulderFlexion, 70), 1.05);
  EXPECT_LT(stretch("pectoralis_sternal", kShoulderFlexion, 70), 0.97);
  EXPECT_GT(stretch("latissimus", kShoulderAbduction, 110), 1.05);
  EXPECT_LT(stretch("pectoralis_clavicular", kShoulderRotation, 45), 1.0);
  EXPECT_GT(stretch("infraspinatus", kShoulderRotation, 45), 1.0);
  EXPECT_LT(stretch("trapezius_upper", kClavicleElevation, 18), 0.98);
  EXPECT_LT(stretch("wrist_flexors", kWristFlexion, 50), 0.99);
  EXPECT_GT(stretch("wrist_extensors", kWristFlexion, 50), 1.005);
  EXPECT_LT(stretch("pronator_teres", kForearmTwist, -70), stretch("pronator_teres", kForearmTwist, 70));
  EXPECT_LT(stretch("finger_flexors", kFingerCurl, 70), 0.99);
}

TEST(ArmMuscles, StayWithinWhatFleshCanDo) {
  for (const Muscle& muscle : arm().muscles) {
    for (int dof = 0; dof < kArmDofCount; ++dof) {
      for (const double degrees : {limits().dofs[dof].min, limits().dofs[dof].max}) {
        const double ratio = stretch(muscle.name, static_cast<ArmDof>(dof), degrees);
        EXPECT_GT(ratio, 0.55) << muscle.name << " at " << limits().dofs[dof].name << " " << degrees;
        EXPECT_LT(ratio, 1.6) << muscle.name << " at " << limits().dofs[dof].name << " " << degrees;
      }
    }
  }
}

}  // namespace arm_muscles_test
}  // namespace bodyopt::trainer
