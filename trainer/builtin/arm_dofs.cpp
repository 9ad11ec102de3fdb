#include "trainer/builtin/arm_dofs.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "runtime/basis/error.h"
#include "runtime/rig.h"
#include "trainer/builtin/anatomy.h"

namespace bodyopt {
namespace {

using Eigen::Vector3d;

Vec3 array_from(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Quat turn(const Vector3d& axis, double degrees) {
  return axis_angle(array_from(axis), degrees * std::numbers::pi / 180);
}

// The upper arm's direction moves by one rotation about a combined axis, so no order of the two angles is special.
Quat swing(const SegmentFrame& arm, double abduction, double flexion) {
  // Turning about -front lifts the arm sideways, about side brings it forwards.
  const Vector3d axis = -abduction * arm.front + flexion * arm.side;
  const double angle = axis.norm();
  return angle > 0 ? turn(axis / angle, angle) : Quat{0, 0, 0, 1};
}

struct JointTurn {
  const char* joint;
  Quat rotation;
};

// `d` are degrees away from the rest pose. Joint axes are the world's at rest.
std::vector<JointTurn> joint_turns(const ArmAngles& d) {
  const SegmentFrame arm = upper_arm_frame(), fore = forearm_frame(), hand = hand_frame();
  const Vector3d up = Vector3d::UnitY(), forward = Vector3d::UnitZ();
  const Quat half_twist = turn(fore.along, 0.5 * d[kForearmTwist]);
  return {
      {"clavicle", turn(-forward, d[kClavicleElevation]) * turn(up, d[kClavicleProtraction])},
      {"shoulder", swing(arm, d[kShoulderAbduction], d[kShoulderFlexion]) * turn(-arm.along, d[kShoulderRotation])},
      {"elbow", turn(fore.side, d[kElbowFlexion])},
      {"forearm", half_twist},
      {"forearm_twist", half_twist},
      {"wrist", turn(hand.front, d[kWristFlexion]) * turn(hand.side, -d[kWristDeviation])},
      {"fingers", turn(hand.front, d[kFingerCurl])},
      {"fingertips", turn(hand.front, 1.1 * d[kFingerCurl])},
      {"thumb", turn((hand.front - 0.5 * hand.along - 0.4 * hand.side).normalized(), 0.4 * d[kFingerCurl])},
  };
}

// A bone with flesh around it, from `from` to `to` in rest space.
struct FleshyBone {
  const char* joint;
  Vector3d from, to;
  double radius;
};

std::vector<FleshyBone> fleshy_bones() {
  const SegmentFrame arm = upper_arm_frame(), fore = forearm_frame(), hand = hand_frame();
  return {
      {"shoulder", arm.at(0.5 * kUpperArmLength, 0, 0), fore.origin, 0.045},
      {"elbow", fore.origin, fore.at(0.5 * kForearmLength, 0, 0), 0.050},
      {"forearm_twist", fore.at(0.5 * kForearmLength, 0, 0), hand.origin, 0.032},
      {"wrist", hand.origin, hand.at(0.09, 0, 0), 0.030},
      {"fingers", hand.at(0.09, 0, 0), hand.at(0.13, 0, -0.010), 0.025},
      {"fingertips", hand.at(0.13, 0, -0.010), hand.at(0.17, 0, -0.030), 0.020},
      {"thumb", thumb().joints[0], thumb().joints[3], 0.015},
  };
}

int find_joint(const Skeleton& skeleton, const std::string& name) {
  const int joint = skeleton.find(name);
  if (joint < 0) {
    throw Error(ErrorKind::mismatch,
                "the skeleton has no joint '" + name + "': the built-in motions are made for the built-in arm only");
  }
  return joint;
}

}  // namespace

ArmAngles arm_rest_angles() {
  ArmAngles angles;
  for (int k = 0; k < kArmDofCount; ++k) angles[k] = kArmLimits[k].rest;
  return angles;
}

bool within_limits(const ArmAngles& angles) {
  for (int k = 0; k < kArmDofCount; ++k) {
    if (!(angles[k] >= kArmLimits[k].low && angles[k] <= kArmLimits[k].high)) return false;
  }
  return true;
}

Pose arm_pose(const Skeleton& skeleton, const ArmAngles& angles) {
  ArmAngles away;
  for (int k = 0; k < kArmDofCount; ++k) away[k] = angles[k] - kArmLimits[k].rest;
  Pose pose = bind_pose(skeleton);
  for (const JointTurn& turn : joint_turns(away)) {
    pose.joints[find_joint(skeleton, turn.joint)].rotation = normalized(turn.rotation);
  }
  return pose;
}

double torso_clearance(const Skeleton& skeleton, const ArmAngles& angles) {
  constexpr int kSamples = 5;
  const Solid torso(torso_parts());
  const std::vector<Affine> skinning = skinning_matrices(skeleton, arm_pose(skeleton, angles).joints);
  double clearance = 1;
  for (const FleshyBone& bone : fleshy_bones()) {
    const Affine& moved = skinning[find_joint(skeleton, bone.joint)];
    for (int k = 0; k <= kSamples; ++k) {
      const Vec3 p = moved * array_from(bone.from + static_cast<double>(k) / kSamples * (bone.to - bone.from));
      clearance = std::min(clearance, torso.distance({p[0], p[1], p[2]}) - bone.radius);
    }
  }
  return clearance;
}

}  // namespace bodyopt
