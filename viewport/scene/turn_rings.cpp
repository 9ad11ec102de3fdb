#include "viewport/scene/turn_rings.h"

#include <algorithm>
#include <numbers>
#include <optional>

#include "runtime/modifiers/drive_modifiers.h"
#include "viewport/scene/scene.h"

namespace bodyopt::viewport {
namespace {

constexpr double kRingRadius = 0.09;  // of the character's size
constexpr double kArrow = 0.13;       // length, of the character's size
constexpr double kFreeTurn = 180;     // degrees, either way, of what has no limits

Vec3 unit_axis(std::size_t axis) {
  Vec3 along{};
  along[axis % 3] = 1;
  return along;
}

}  // namespace

Vec3 TurnRing::point(double degrees) const {
  return centre + radius * rotate(axis_angle(along, degrees * std::numbers::pi / 180), zero);
}

std::vector<TurnRing> turn_rings(const Scene& scene, const Controls& controls) {
  if (scene.empty() || controls.joint.empty()) return {};
  if (controls.tool == Tool::move && !move_arrows(scene, controls).empty()) return {};
  const Actor& lead = scene.lead();
  const int found = lead.basis().skeleton.find(controls.joint);
  if (found < 0) return {};
  const auto joint = static_cast<std::size_t>(found);
  const Vec3 angles = shots::set_or(controls.settings.pose.joints, controls.joint, {});
  const Quat posed = world_rotations(lead.basis().skeleton, scene.lead_pose(controls))[joint];
  const Quat before = posed * conjugate(shots::turn_of(angles));  // where the clip has it
  const std::optional<shots::JointRange> free = lead.free_turns(joint, controls.playback.frame());
  const Vec3 centre = scene.joint_centres(controls)[joint];
  // x is applied first: y and z carry its axis along.
  const Quat carried[] = {before * shots::turn_of({0, angles[1], angles[2]}),
                          before * shots::turn_of({0, 0, angles[2]}), before};
  std::vector<TurnRing> rings;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    rings.push_back({axis, centre, rotate(carried[axis], unit_axis(axis)), rotate(carried[axis], unit_axis(axis + 1)),
                     kRingRadius * lead.size() * (1 - 0.06 * static_cast<double>(axis)),
                     free ? free->low[axis] : -kFreeTurn, free ? free->high[axis] : kFreeTurn, angles[axis]});
  }
  return rings;
}

std::vector<MoveArrow> move_arrows(const Scene& scene, const Controls& controls) {
  const auto& movable = controls.movable_names;
  if (scene.empty() || controls.tool == Tool::turn || std::ranges::find(movable, controls.joint) == movable.end()) {
    return {};
  }
  const auto joint = static_cast<std::size_t>(scene.lead().basis().skeleton.find(controls.joint));
  const Vec3 from = scene.joint_centres(controls)[joint];
  std::vector<MoveArrow> arrows;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    arrows.push_back({axis, from, from + kArrow * scene.lead().size() * unit_axis(axis)});
  }
  return arrows;
}

}  // namespace bodyopt::viewport
