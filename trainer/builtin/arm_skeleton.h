// The joints of the built-in character and the flesh that moves with each.
#pragma once

#include <vector>

#include "runtime/basis/skeleton.h"
#include "trainer/builtin/weights.h"

namespace bodyopt {

// Bind rotations are all zero: at rest every joint's axes are those of the world.
Skeleton arm_skeleton();

std::vector<JointRegion> arm_joint_regions();  // one per joint, for the skin weights

}  // namespace bodyopt
