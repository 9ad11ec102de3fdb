// Turns of joints as sliders have them: about x, then y, then z, degrees.
#pragma once

#include "runtime/core/transform.h"

namespace bodyopt {

Quat turn_of(const Vec3& degrees);

// Of the angles that make the turn, those that are smallest in sum.
Vec3 degrees_of(const Quat& turn);

}  // namespace bodyopt
