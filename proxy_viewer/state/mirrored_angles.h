// How the other side's joint turns as this one does.
#pragma once

#include "runtime/core/transform.h"

namespace bodyopt {

// Of a joint's turn (about x, then y, then z, degrees), the one of the other side's joint that makes it the mirror
// image at the plane x = 0. `axes`, `other_axes`: rotations of the two in the bind pose, joint to world.
Vec3 mirrored_angles(const Vec3& degrees, const Quat& axes, const Quat& other_axes);

}  // namespace bodyopt
