// Weights of 1: the strength alone says how much is shown.
#include <algorithm>

#include "runtime/modifiers/skin_modifier_type.h"

namespace bodyopt {

void drive_constant(const ModifierFrames&, std::span<float> weights) { std::ranges::fill(weights, 1.0f); }

}  // namespace bodyopt
