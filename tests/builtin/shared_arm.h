// The built-in character, read once per test program, and its degrees of freedom.
#pragma once

#include "trainer/builtin/arm.h"

namespace bodyopt {

inline const trainer::BuiltinArm& arm() {
  static const trainer::BuiltinArm built = trainer::build_arm();
  return built;
}

// In the order of rigs/arm/limits.json.
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

}  // namespace bodyopt
