// The degrees of freedom of the built-in character.
#pragma once

#include "trainer/motion/joint_limits.h"

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

// Of build_arm()'s skeleton, in the order of ArmDof. Anatomical angles: 0 is the arm straight down, elbow straight,
// hand neither pronated nor bent, fingers straight. The torso has none. Throws Error(mismatch) when the skeleton is
// another one.
JointLimits arm_limits(const Skeleton& skeleton);

}  // namespace bodyopt
