// The degrees of freedom of the built-in character, their limits, and poses made of them.
#pragma once

#include <array>

#include "runtime/basis/skeleton.h"

namespace bodyopt {

enum ArmDof {
  kClavicleElevation,
  kClavicleProtraction,
  kShoulderAbduction,
  kShoulderFlexion,
  kShoulderRotation,
  kElbowFlexion,
  kForearmTwist,
  kWristFlexion,
  kWristDeviation,
  kFingerCurl,
};
inline constexpr int kArmDofCount = kFingerCurl + 1;

struct DofLimits {
  const char* name;
  double rest;  // degrees, in the bind pose
  double low;   // degrees
  double high;
};

// Anatomical angles: 0 is the arm straight down, elbow straight, hand neither pronated nor bent, fingers straight.
inline constexpr std::array<DofLimits, kArmDofCount> kArmLimits{{
    {"clavicle_elevation", 0, -8, 20},     // up
    {"clavicle_protraction", 0, -15, 18},  // forwards
    {"shoulder_abduction", 50, 24, 115},   // sideways and up; at the shoulder joint, the clavicle adds to it
    {"shoulder_flexion", 0, -35, 80},      // forwards
    {"shoulder_rotation", 0, -50, 50},     // of the humerus about itself, positive inwards
    {"elbow_flexion", 20, 0, 130},
    {"forearm_twist", 0, -75, 75},    // positive: supination
    {"wrist_flexion", 0, -55, 60},    // towards the palm
    {"wrist_deviation", 0, -20, 28},  // positive towards the little finger
    {"finger_curl", 12, 0, 75},       // at the knuckles
}};

using ArmAngles = std::array<double, kArmDofCount>;  // degrees

ArmAngles arm_rest_angles();
bool within_limits(const ArmAngles& angles);

// The pose of build_arm()'s skeleton with these angles; the torso stays at rest. Throws Error(mismatch) when the
// skeleton is another one.
Pose arm_pose(const Skeleton& skeleton, const ArmAngles& angles);

// How far the limb stays from the torso, metres: the smallest gap between flesh-thick bones and the torso's skin. The
// upper arm counts from its middle on; negative when limb and torso overlap.
double torso_clearance(const Skeleton& skeleton, const ArmAngles& angles);

}  // namespace bodyopt
