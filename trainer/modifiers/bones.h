// Bones between joints, in rest space, metres.
#pragma once

#include "runtime/basis/skeleton.h"

namespace bodyopt {

// From a joint to the middle of those that follow it, or, of the last of a chain, on from its parent; zero of a joint
// that stands alone.
Vec3 bone_of(const Skeleton& skeleton, std::uint32_t joint);

}  // namespace bodyopt
