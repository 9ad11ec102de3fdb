// Sculpt: 1 at the pose it was made for, 0 from the spread on, between them smooth. How far a pose is off is the
// largest turn of the joints that the sculpt listens to, before modifiers turn them.
//   Joints: those. Numbers: the spread, radians, then the rotation of each of the joints at the pose (x, y, z, w).
#include <algorithm>
#include <cmath>

#include "runtime/modifiers/skin_modifier_type.h"

namespace bodyopt {
namespace {

double nearness(double distance, double spread) {
  if (!(distance < spread)) return 0;
  const double near = 1 - distance / spread;
  return near * near * (3 - 2 * near);
}

}  // namespace

void drive_sculpt(const ModifierFrames& frames, std::span<float> weights) {
  const SkinModifier& modifier = frames.modifier;
  const double spread = static_cast<double>(modifier.numbers.at(0));
  for (std::size_t f = 0; f < frames.count(); ++f) {
    double furthest = 0;
    for (std::size_t k = 0; k < modifier.joints.size(); ++k) {
      Quat own;
      for (std::size_t i = 0; i < 4; ++i) own[i] = static_cast<double>(modifier.numbers.at(1 + 4 * k + i));
      const Quat& posed = frames.poses[f].own_joints()[modifier.joints[k]].rotation;
      furthest = std::max(furthest, angle_between(normalized(own), normalized(posed)));
    }
    const double always = static_cast<double>(frames.controls[0][f]);
    weights[f] = static_cast<float>(std::lerp(nearness(furthest, spread), 1.0, always));
  }
}

}  // namespace bodyopt
