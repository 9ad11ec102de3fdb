// Turns of joints as sliders have them: about x, then y, then z, degrees.
#pragma once

#include "runtime/basis/transform.h"

namespace bodyopt {

Quat turn_of(const Vec3& degrees);

// Of the angles that make the turn, those that are smallest in sum.
Vec3 degrees_of(const Quat& turn);

// The other angles that make the same turn: half a turn about x and z, and y from the other side.
Vec3 same_turn(const Vec3& degrees);

}  // namespace bodyopt
