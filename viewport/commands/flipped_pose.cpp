#include "viewport/commands/flipped_pose.h"

#include <algorithm>
#include <utility>

#include "assets/clips/joint_roles.h"
#include "runtime/core/error.h"
#include "shots/session/pinned_joints.h"
#include "shots/session/posed_clip.h"

namespace bodyopt::viewport {
namespace {

std::string other_or_itself(const std::string& name, const std::vector<std::string>& names) {
  std::string other = mirrored_name(name, names);
  return other.empty() ? name : other;
}

// Returns a joint's axes in the bind pose, joint to world; null: there is no such joint.
const Quat* axes_of(const Controls& controls, const std::string& joint) {
  const auto at = std::ranges::find(controls.joint_names, joint) - controls.joint_names.begin();
  return at < std::ssize(controls.joint_axes) ? &controls.joint_axes[static_cast<std::size_t>(at)] : nullptr;
}

// How a joint faces in the world, seen in a mirror, is how the other does.
Vec3 flipped_facing(const Vec3& degrees, const Quat& axes, const Quat& other) {
  const Quat none{0, 0, 0, 1};
  const Quat away = shots::turn_of(degrees) * conjugate(axes);
  return shots::degrees_of(shots::turn_of(shots::mirrored_angles(shots::degrees_of(away), none, none)) * other);
}

template <typename Value>
void put(const std::map<std::string, Value>& from, const std::string& name, std::map<std::string, Value>& into) {
  into.erase(name);
  if (const auto found = from.find(name); found != from.end()) into[name] = found->second;
}

}  // namespace

std::vector<std::string> axes_turning(const Controls& controls, const std::string& joint) {
  std::vector<std::string> axes;
  for (std::size_t k = 0; k < controls.axis_joints.size(); ++k) {
    if (controls.axis_joints[k] == joint) axes.push_back(controls.axis_names[k]);
  }
  return axes;
}

void put_pose(const Controls& controls, const shots::ViewSettings::PoseKey& pose,
              const std::vector<std::string>& joints, shots::ViewSettings::PoseKey& into) {
  if (joints.empty()) {
    shots::ViewSettings::PoseKey whole = pose;
    whole.ease = into.ease;  // of the key, not of the pose
    whole.eases = std::move(into.eases);
    into = std::move(whole);
  }
  for (const std::string& joint : joints) {
    put(pose.joints, joint, into.joints);
    put(pose.moves, joint, into.moves);
    put(pose.pins, joint, into.pins);
    put(pose.facing, joint, into.facing);
    for (const std::string& axis : axes_turning(controls, joint)) put(pose.axes, axis, into.axes);
  }
}

shots::ViewSettings::PoseKey part_of(const Controls& controls, const shots::ViewSettings::PoseKey& pose,
                                     const std::vector<std::string>& joints) {
  shots::ViewSettings::PoseKey part;
  put_pose(controls, pose, joints, part);
  return part;
}

void blend_in(Controls& controls, const shots::ViewSettings::PoseKey& pose, double share,
              const shots::ViewSettings::PoseKey& before) {
  shots::ViewSettings::PoseKey wanted = before;
  put_pose(controls, pose, controls.selected(), wanted);
  static_cast<shots::ViewSettings::PoseKey&>(controls.settings.pose) = shots::blended(before, wanted, share);
}

void require_own_pose(const Controls& controls, const shots::ViewSettings::PoseKey& pose, const std::string& file) {
  const auto is_own = [&](const auto& named) {
    return std::ranges::find(controls.joint_names, named.first) != controls.joint_names.end();
  };
  if (pose.joints.empty() || std::ranges::any_of(pose.joints, is_own)) return;
  throw Error(ErrorKind::mismatch, file + ": poses '" + pose.joints.begin()->first +
                                       "', expected joints of the lead: is it of another character?");
}

shots::ViewSettings::PoseKey flipped(const Controls& controls, const shots::ViewSettings::PoseKey& pose, int frame) {
  const std::vector<std::string>& joints = controls.joint_names;
  const double plane = controls.root_x ? controls.root_x(frame) : 0;
  shots::ViewSettings::PoseKey flipped;
  flipped.ease = pose.ease;
  for (const auto& [name, ease] : pose.eases) {
    const bool is_joint = std::ranges::find(joints, name) != joints.end();
    const std::string other = other_or_itself(name, is_joint ? joints : controls.axis_names);
    flipped.eases[other == name ? other_or_itself(name, controls.control_names) : other] = ease;
  }
  for (const auto& [joint, degrees] : pose.joints) {
    const std::string other = other_or_itself(joint, joints);
    const Quat *from = axes_of(controls, joint), *to = axes_of(controls, other);
    if (from && to) flipped.joints[other] = shots::mirrored_angles(degrees, *from, *to);
  }
  for (const auto& [axis, degrees] : pose.axes) {
    const std::string other = other_or_itself(axis, controls.axis_names);
    const auto at = std::ranges::find(controls.axis_names, axis) - controls.axis_names.begin();
    const bool is_middle = other == axis && at < std::ssize(controls.axes_flip);
    flipped.axes[other] = is_middle && controls.axes_flip[static_cast<std::size_t>(at)] ? -degrees : degrees;
  }
  for (const auto& [control, value] : pose.controls) {
    flipped.controls[other_or_itself(control, controls.control_names)] = value;
  }
  for (const auto& [joint, at] : pose.pins) {
    flipped.pins[other_or_itself(joint, joints)] = {2 * plane - at[0], at[1], at[2]};
  }
  for (const auto& [joint, by] : pose.moves) flipped.moves[other_or_itself(joint, joints)] = {-by[0], by[1], by[2]};
  for (const auto& [joint, degrees] : pose.facing) {
    const std::string other = other_or_itself(joint, joints);
    const Quat *from = axes_of(controls, joint), *to = axes_of(controls, other);
    if (from && to) flipped.facing[other] = flipped_facing(degrees, *from, *to);
  }
  return flipped;
}

std::vector<std::string> flipped(const Controls& controls, const std::vector<std::string>& joints) {
  std::vector<std::string> others;
  for (const std::string& joint : joints) others.push_back(other_or_itself(joint, controls.joint_names));
  return others;
}

}  // namespace bodyopt::viewport
