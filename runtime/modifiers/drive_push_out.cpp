// Push-out: at work where a joint is bent one way so far that its skin may fold there. That it has begun changes
// nothing yet: no skin has crossed any.
//   joints: of each component, which is a joint bent one way;  numbers: for each an axis in rest space over the bend,
//   radians, from which on it is at work
#include "runtime/modifiers/joint_turns.h"
#include "runtime/modifiers/skin_modifier_type.h"

namespace bodyopt {

void drive_push_out(const ModifierFrames& frames, std::span<float> weights) {
  const SkinModifier& modifier = frames.modifier;
  for (std::size_t f = 0; f < frames.count(); ++f) {
    const std::vector<Vec3> bends = fold_bends(frames.basis.skeleton, frames.poses[f]);
    for (std::size_t k = 0; k < modifier.component_count; ++k) {
      Vec3 axis;
      for (std::size_t i = 0; i < 3; ++i) axis[i] = static_cast<double>(modifier.numbers.at(3 * k + i));
      weights[f * modifier.component_count + k] = dot(bends[modifier.joints.at(k)], axis) > 1 ? 1.0f : 0.0f;
    }
  }
}

}  // namespace bodyopt
