#include "shots/session/posed_clip.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string>
#include <utility>

#include "assets/shot_modifiers.h"
#include "runtime/host/rig.h"
#include "shots/session/pinned_joints.h"

namespace bodyopt {
namespace {

Vec3 blend_of(const Vec3& a, const Vec3& b, double t) { return (1 - t) * a + t * b; }
double blend_of(double a, double b, double t) { return std::lerp(a, b, t); }

// `whole`: what one side lacks is as the other has it; otherwise it is zero there.
template <typename Value>
std::map<std::string, Value> blend_of(const std::map<std::string, Value>& a, const std::map<std::string, Value>& b,
                                      double t, bool whole) {
  std::map<std::string, Value> blended;
  for (const auto& [name, value] : a) {
    const auto other = b.find(name);
    blended[name] = blend_of(value, other != b.end() ? other->second : whole ? value : Value{}, t);
  }
  for (const auto& [name, value] : b) {
    if (!a.contains(name)) blended[name] = blend_of(whole ? value : Value{}, value, t);
  }
  return blended;
}

// Of a joint's local rotation, about an axis of rest space.
Quat turn_about_rest_axis(const Skeleton& skeleton, const JointTurn& turn, double degrees) {
  const int parent = skeleton.joints[turn.joint].parent;
  Vec3 axis = turn.axis;
  if (parent >= 0) axis = rotate(conjugate(bind_rotations(skeleton)[static_cast<std::size_t>(parent)]), axis);
  return axis_angle(axis, turn.share * degrees * std::numbers::pi / 180);
}

// Names of the controls that the clip has, or the posing sets at any frame.
std::vector<std::string> posed_controls(const Clip& clip, const ViewSettings::Posing& posing) {
  std::vector<std::string> names = clip.controls;
  const auto add = [&](const ViewSettings::PoseKey& key) {
    for (const auto& [name, value] : key.controls) {
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  };
  add(posing);
  for (const auto& [frame, key] : posing.keys) add(key);
  return names;
}

// A value of the pose for each of the names: that of the posing, where it has one.
void set_posed_controls(const std::vector<std::string>& names, const ViewSettings::PoseKey& posing, Pose& pose) {
  pose.controls.resize(names.size(), 0.0f);
  for (const auto& [name, value] : posing.controls) {
    const auto at = static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
    if (at < names.size()) pose.controls[at] = static_cast<float>(value);
  }
}

}  // namespace

ViewSettings::PoseKey between_keys(const std::map<int, ViewSettings::PoseKey>& keys, int frame) {
  const auto after = keys.lower_bound(frame);
  if (after == keys.begin() || (after != keys.end() && after->first == frame)) return after->second;
  const auto before = std::prev(after);
  if (after == keys.end()) return before->second;
  const double x = (static_cast<double>(frame) - before->first) / (static_cast<double>(after->first) - before->first);
  const double t = x * x * (3 - 2 * x);
  const ViewSettings::PoseKey &a = before->second, &b = after->second;
  return {blend_of(a.joints, b.joints, t, false), blend_of(a.axes, b.axes, t, false),
          blend_of(a.controls, b.controls, t, true), blend_of(a.pins, b.pins, t, true)};
}

ViewSettings::Posing keyed_posing(ViewSettings::Posing posing, int frame) {
  if (!posing.keys.empty()) static_cast<ViewSettings::PoseKey&>(posing) = between_keys(posing.keys, frame);
  return posing;
}

Clip still_clip(const Skeleton& skeleton, const ClipOptions& options) {
  constexpr double kSeconds = 10;
  Clip clip;
  clip.name = "bind pose";
  clip.fps = options.fps;
  clip.first_frame = options.first_frame;
  clip.poses.assign(std::max<std::size_t>(1, static_cast<std::size_t>(kSeconds * options.fps)), bind_pose(skeleton));
  return clip;
}

Pose posed(const Skeleton& skeleton, const JointLimits& limits, const std::vector<std::optional<JointRange>>& ranges,
           Pose pose, const ViewSettings::PoseKey& posing) {
  for (const DegreeOfFreedom& dof : limits.dofs) {
    const auto found = posing.axes.find(dof.name);
    if (found == posing.axes.end()) continue;
    for (const JointTurn& turn : dof.turns) {
      Quat& rotation = pose.joints[turn.joint].rotation;
      rotation = turn_about_rest_axis(skeleton, turn, found->second) * rotation;
    }
  }
  for (const auto& [joint, degrees] : posing.joints) {
    const int found = skeleton.find(joint);
    if (found < 0) continue;
    const auto index = static_cast<std::size_t>(found);
    Quat& rotation = pose.joints[index].rotation;
    const bool is_limited = index < ranges.size() && ranges[index];
    rotation = is_limited ? turned_within(*ranges[index], skeleton.joints[index].bind.rotation, rotation, degrees)
                          : normalized(rotation * turn_of(degrees));
  }
  return pinned(skeleton, ranges, std::move(pose), posing.pins);
}

Pose posed_frame(const Clip& clip, std::size_t at, const Basis& basis, const JointLimits& limits,
                 const std::vector<std::optional<JointRange>>& ranges, const ViewSettings::Posing& posing) {
  // Of the frames before it the controls matter: a breath goes on from frame to frame.
  const std::size_t first = basis.modifiers.empty() ? at : 0;
  Clip part;
  part.fps = clip.fps;
  part.first_frame = clip.first_frame + static_cast<int>(first);
  part.controls = posed_controls(clip, posing);
  part.poses.assign(clip.poses.begin() + static_cast<std::ptrdiff_t>(first),
                    clip.poses.begin() + static_cast<std::ptrdiff_t>(at + 1));
  for (std::size_t k = 0; k < part.poses.size(); ++k) {
    const bool is_keyed = first + k < at && !posing.keys.empty();
    const ViewSettings::PoseKey here =
        is_keyed ? between_keys(posing.keys, part.first_frame + static_cast<int>(k)) : ViewSettings::PoseKey(posing);
    set_posed_controls(part.controls, here, part.poses[k]);
  }
  part.poses.back() = posed(basis.skeleton, limits, ranges, std::move(part.poses.back()), posing);
  apply_channels(basis, part);
  return std::move(part.poses.back());
}

Clip posed_clip(Clip clip, const Skeleton& skeleton, const JointLimits& limits, const ViewSettings::Posing& posing) {
  const std::vector<std::optional<JointRange>> ranges =
      limits.dofs.empty() ? std::vector<std::optional<JointRange>>() : joint_ranges(limits, skeleton);
  const std::vector<std::string> controls = posed_controls(clip, posing);
  for (std::size_t k = 0; k < clip.poses.size(); ++k) {
    const ViewSettings::Posing here = keyed_posing(posing, clip.first_frame + static_cast<int>(k));
    clip.poses[k] = posed(skeleton, limits, ranges, std::move(clip.poses[k]), here);
    set_posed_controls(controls, here, clip.poses[k]);
  }
  clip.controls = controls;
  return clip;
}

}  // namespace bodyopt
