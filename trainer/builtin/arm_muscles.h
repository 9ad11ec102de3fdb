// The muscles of the built-in character.
#pragma once

#include <vector>

#include "assets/muscles.h"
#include "runtime/basis/skeleton.h"

namespace bodyopt {

std::vector<Muscle> arm_muscles(const Skeleton& skeleton);

}  // namespace bodyopt
