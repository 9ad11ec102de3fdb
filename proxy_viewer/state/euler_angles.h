// Turns of joints as sliders have them: about x, then y, then z, degrees.
#pragma once

#include "runtime/core/transform.h"

namespace bodyopt {

Quat turn_of(const Vec3& degrees);

// Of the angles that make the turn, those that are smallest in sum.
Vec3 degrees_of(const Quat& turn);

// Of a joint's turn, the one of the other side's joint that makes it the mirror
// image at the plane x = 0. `axes`, `other_axes`: rotations of the two in the bind pose, joint to world.
Vec3 mirrored_angles(const Vec3& degrees, const Quat& axes, const Quat& other_axes);

}  // namespace bodyopt
