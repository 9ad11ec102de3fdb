// What is on the other side of a body is called.
#pragma once

#include <span>
#include <string>

namespace bodyopt {

// "RightArm" for "LeftArm", also left and LEFT; a letter that stands alone, as in "L_Arm", "arm_l", "Bip01 L Arm",
// "arm.L"; or one at the end of a word with capitals, "LThumb", "ThumbL". Empty where `names` has no such name.
std::string mirrored_name(const std::string& name, std::span<const std::string> names);

}  // namespace bodyopt
