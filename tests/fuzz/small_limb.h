// The limb of the simulation's tests, which small files are read for.
#pragma once

#include "tests/simulate/limb.h"

namespace bodyopt::fuzz {

inline const Character& limb() {
  static const Character character = make_limb();
  return character;
}

}  // namespace bodyopt::fuzz
