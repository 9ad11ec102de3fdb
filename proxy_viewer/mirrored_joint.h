// Which joint is the other side's, by its name.
#pragma once

#include <span>
#include <string>

#include "runtime/basis/transform.h"

namespace bodyopt {

// "LeftArm": "RightArm"; also left, LEFT, L before a capital, and _l, .L at the end. Empty where `names` has no such
// joint.
std::string mirrored_joint(const std::string& name, std::span<const std::string> names);

// Euler angles reflected at the plane x = 0: of joints whose axes are the mirror images of each other's, as where no
// joint turns its axes in the bind pose.
constexpr Vec3 mirrored_angles(const Vec3& degrees) { return {degrees[0], -degrees[1], -degrees[2]}; }

}  // namespace bodyopt
