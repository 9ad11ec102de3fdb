// How joints stand in the world.
#pragma once

#include <vector>

#include "runtime/basis/skeleton.h"

namespace bodyopt {

// Rotations of all joints of a pose, world.
std::vector<Quat> world_rotations(const Skeleton& skeleton, const Pose& pose);

}  // namespace bodyopt
