// Poses as the backends see them: the rig stage, on the host.
#pragma once

#include <span>

#include "runtime/host/backend.h"

namespace bodyopt {

struct Pose;

// Throws Error(mismatch) when a pose does not fit the skeleton, or holds a number that is not finite.
Batch make_batch(const Basis& basis, std::span<const Pose> poses);

}  // namespace bodyopt
