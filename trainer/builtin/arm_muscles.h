// The muscles of the built-in character.
#pragma once

#include <vector>

#include "runtime/basis/skeleton.h"
#include "trainer/dataset/muscles.h"

namespace bodyopt {

std::vector<Muscle> arm_muscles(const Skeleton& skeleton);

}  // namespace bodyopt
