// The other side's joint, and how it turns as this one does.
#pragma once

#include <span>
#include <string>

#include "runtime/core/transform.h"

namespace bodyopt {

// By its name: "LeftArm" and "RightArm", also left and LEFT; a letter that stands alone, as in "L_Arm", "arm_l",
// "Bip01 L Arm", "arm.L"; or one at the end of a word with capitals, "LThumb", "ThumbL". Empty where `names` has no
// such joint.
std::string mirrored_joint(const std::string& name, std::span<const std::string> names);

// Of a joint's turn (about x, then y, then z, degrees), the one of the other side's joint that makes it the mirror
// image at the plane x = 0. `axes`, `other_axes`: rotations of the two in the bind pose, joint to world.
Vec3 mirrored_angles(const Vec3& degrees, const Quat& axes, const Quat& other_axes);

}  // namespace bodyopt
