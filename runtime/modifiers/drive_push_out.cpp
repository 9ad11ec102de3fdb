// Push-out: at work where a joint is bent so far that its skin may fold. That it has begun there changes nothing yet:
// no skin has crossed any.
//   joints: those that fold skin, a component each;  numbers: the reach (of the kernel), then from which bend on each
//   of them is at work, radians
#include "runtime/modifiers/fold_bend.h"
#include "runtime/modifiers/skin_modifier_type.h"

namespace bodyopt {

void drive_push_out(const ModifierFrames& frames, std::span<float> weights) {
  const SkinModifier& modifier = frames.modifier;
  for (std::size_t f = 0; f < frames.count(); ++f) {
    for (std::size_t k = 0; k < modifier.component_count; ++k) {
      const double from = static_cast<double>(modifier.numbers.at(1 + k));
      const double bend = fold_bend(frames.basis.skeleton, frames.poses[f], modifier.joints.at(k));
      weights[f * modifier.component_count + k] = bend > from ? 1.0f : 0.0f;
    }
  }
}

}  // namespace bodyopt
