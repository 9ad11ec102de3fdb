#include "trainer/builtin/arm_skeleton.h"

#include "trainer/builtin/anatomy.h"

namespace bodyopt {
namespace {

using Eigen::Vector3d;

// Where a joint is, what moves with it, and how soft its border is (see JointRegion).
struct JointPlan {
  std::string name;
  int parent;
  Vector3d position;
  JointRegion region;
};

std::vector<RoundedPart> finger_bones(int first, int last) {
  std::vector<RoundedPart> bones;
  for (const Finger& finger : fingers()) {
    for (int k = first; k < last; ++k) {
      bones.push_back(limb(finger.joints[k], finger.joints[k + 1], finger.radii[k], finger.radii[k + 1], 0.001));
    }
  }
  return bones;
}

std::vector<RoundedPart> palm_bones() {
  const SegmentFrame hand = hand_frame();
  std::vector<RoundedPart> bones;
  for (const Finger& finger : fingers()) bones.push_back(limb(hand.origin, finger.joints[0], 0.016, 0.010, 0.001));
  return bones;
}

std::vector<RoundedPart> thumb_bones() {
  const Finger finger = thumb();
  return {limb(finger.joints[0], finger.joints[1], finger.radii[0], finger.radii[1], 0.001),
          limb(finger.joints[1], finger.joints[3], finger.radii[1], finger.radii[3], 0.001)};
}

Vector3d mean_finger_joint(int k) {
  Vector3d sum = Vector3d::Zero();
  for (const Finger& finger : fingers()) sum += finger.joints[k] / 4;
  return sum;
}

std::vector<JointPlan> plan_joints() {
  const SegmentFrame arm = upper_arm_frame(), fore = forearm_frame(), hand = hand_frame();
  const Vector3d up = Vector3d::UnitY(), right = -Vector3d::UnitX();
  const Vector3d twist_start = fore.at(0.25 * kForearmLength, 0, 0), twist_end = fore.at(0.65 * kForearmLength, 0, 0);
  const auto region = [](std::vector<RoundedPart> solid, double softness) {
    return JointRegion{Solid(std::move(solid)), softness};
  };
  return {
      {"torso",
       -1,
       {-0.050, 1.220, -0.010},
       region({belly({0, 1.240, 0}, up, right, {0.300, 0.150, 0.115}, 0.02),
               limb({0, 1.43, -0.02}, {0, 1.60, 0}, 0.065, 0.06, 0.02)},
              0.035)},
      {"clavicle",
       0,
       {-0.030, 1.445, 0.030},
       region({limb({-0.060, 1.455, 0.035}, {-0.180, 1.470, -0.010}, 0.020, 0.026, 0.02),
               limb({-0.160, 1.450, -0.040}, {-0.100, 1.350, -0.080}, 0.030, 0.030, 0.02)},
              0.035)},
      {"shoulder", 1, arm.origin,
       region({limb(arm.at(0.035, 0, 0), arm.at(kUpperArmLength, 0, 0), 0.050, 0.036, 0.02)}, 0.030)},
      {"elbow", 2, fore.origin, region({limb(fore.origin, twist_start, 0.036, 0.036, 0.02)}, 0.020)},
      {"forearm", 3, twist_start, region({limb(twist_start, twist_end, 0.036, 0.036, 0.02)}, 0.030)},
      {"forearm_twist", 4, twist_end, region({limb(twist_end, hand.origin, 0.036, 0.030, 0.02)}, 0.025)},
      {"wrist", 5, hand.origin, region(palm_bones(), 0.014)},
      {"fingers", 6, mean_finger_joint(0), region(finger_bones(0, 1), 0.007)},
      {"fingertips", 7, mean_finger_joint(1), region(finger_bones(1, 3), 0.006)},
      {"thumb", 6, thumb().joints[0], region(thumb_bones(), 0.010)},
  };
}

}  // namespace

Skeleton arm_skeleton() {
  const std::vector<JointPlan> plan = plan_joints();
  Skeleton skeleton;
  for (const JointPlan& p : plan) {
    const Vector3d offset = p.parent < 0 ? p.position : Vector3d(p.position - plan[p.parent].position);
    Joint joint;
    joint.name = p.name;
    joint.parent = p.parent;
    joint.bind.translation = {offset.x(), offset.y(), offset.z()};
    joint.default_local = joint.bind;
    for (int k = 0; k < 3; ++k) joint.inverse_bind.m[k][3] = -p.position[k];
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

std::vector<JointRegion> arm_joint_regions() {
  std::vector<JointRegion> regions;
  for (const JointPlan& p : plan_joints()) regions.push_back(p.region);
  return regions;
}

}  // namespace bodyopt
