// A clip's channels to what the modifiers make of them: the weights of their components, and turned joints.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

// Names of all channels that the modifiers of a basis know.
std::vector<std::string> modifier_channels(const SkinModifiers& modifiers);

// Applies the stack, in its order, to a clip's poses, which are consecutive frames. `channels`: names of the poses'
// controls; those that are none of the modifiers' are left alone. Fills Pose::modifiers, and turns joints, whose poses
// before stay in Pose::unmodified. Returns what was clamped, a sentence each. Throws Error(mismatch) for a modifier of
// a type that is not known, or tables that do not fit its type.
std::vector<std::string> drive_modifiers(const Basis& basis, std::span<const std::string> channels,
                                         double frames_per_second, std::span<Pose> poses);

}  // namespace bodyopt
