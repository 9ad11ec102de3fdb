// Flex: as hard as it is activated.
#include "runtime/modifiers/skin_modifier_type.h"

namespace bodyopt {

void drive_flex(const ModifierFrames& frames, std::span<float> weights) {
  for (std::size_t f = 0; f < frames.count(); ++f) weights[f] = frames.controls[0][f];
}

}  // namespace bodyopt
