// The built-in character, built once per test program.
#pragma once

#include "trainer/builtin/arm.h"

namespace bodyopt {

inline const BuiltinArm& arm() {
  static const BuiltinArm built = build_arm();
  return built;
}

}  // namespace bodyopt
