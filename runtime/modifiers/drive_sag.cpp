// Sag: how gravity differs from the earth's, downwards, as each joint feels it.
//   Joints: those that soft parts go with. Components: three to a joint, for a difference of once the earth's gravity.
//   They are along x, y and z of the rest space that moves along with the joint.
#include <numbers>
#include <stdexcept>

#include "runtime/modifiers/drive_modifiers.h"
#include "runtime/modifiers/skin_modifier_type.h"

namespace bodyopt {
namespace {

// The difference in parts of the earth's gravity, world axes, Y up.
Vec3 difference_of_gravity(double amount, double forward, double sideways) {
  const double degree = std::numbers::pi / 180;
  const Quat tilt = axis_angle({0, 0, 1}, sideways * degree) * axis_angle({1, 0, 0}, -forward * degree);
  return amount * rotate(tilt, {0, -1, 0}) - Vec3{0, -1, 0};
}

}  // namespace

void drive_sag(const ModifierFrames& frames, std::span<float> weights) {
  const SkinModifier& modifier = frames.modifier;
  if (modifier.component_count != 3 * modifier.joints.size()) throw std::out_of_range("components of sag");
  const Skeleton& skeleton = frames.basis.skeleton;
  const std::vector<Quat> bind = world_rotations(skeleton, bind_pose(skeleton));
  for (std::size_t f = 0; f < frames.count(); ++f) {
    const auto control = [&](std::size_t k) { return static_cast<double>(frames.controls[k][f]); };
    const Vec3 difference = difference_of_gravity(control(0), control(1), control(2));
    const std::vector<Quat> posed = world_rotations(skeleton, frames.poses[f]);
    for (std::size_t k = 0; k < modifier.joints.size(); ++k) {
      const std::uint32_t joint = modifier.joints[k];
      const Vec3 felt = rotate(bind[joint] * conjugate(posed[joint]), difference);
      for (std::size_t i = 0; i < 3; ++i) {
        weights[f * modifier.component_count + 3 * k + i] = static_cast<float>(felt[i]);
      }
    }
  }
}

}  // namespace bodyopt
