#include "shots/session/posed_clip.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "assets/clips/shot_modifiers.h"
#include "runtime/host/rig.h"
#include "runtime/modifiers/drive_modifiers.h"
#include "shots/session/pinned_joints.h"

namespace bodyopt::shots {
namespace {

Vec3 blend_of(const Vec3& a, const Vec3& b, double t) { return (1 - t) * a + t * b; }
double blend_of(double a, double b, double t) { return std::lerp(a, b, t); }

using PoseKey = ViewSettings::PoseKey;

// Blends what two keys have by names of joints, axes or controls.
class KeyBlend {
 public:
  explicit KeyBlend(const KeySpan<PoseKey>& span) : span_(span) {}
  // All go the same share of the way.
  KeyBlend(const PoseKey& a, const PoseKey& b, double share) : span_{.a = a, .b = b, .x = share}, is_even_(true) {}

  PoseKey pose() const {
    return {all(&PoseKey::joints, false),
            all(&PoseKey::axes, false),
            all(&PoseKey::controls, true),
            all(&PoseKey::pins, true),
            all(&PoseKey::moves, false),
            facing(),
            span_.a.ease,
            span_.a.eases};
  }

 private:
  template <typename Value>
  using Named = std::map<std::string, Value> PoseKey::*;

  static KeyEase ease(const PoseKey& key, const std::string& name) { return set_or(key.eases, name, key.ease); }
  bool goes_by_spline(const std::string& name) const { return !is_even_ && ease(span_.a, name) == KeyEase::spline; }
  double share(const std::string& name) const { return is_even_ ? span_.x : eased(ease(span_.a, name), span_.x); }

  SplineValues around(const std::string& name, double a, double b, const auto& number_of) const {
    return {span_.before ? number_of(*span_.before) : std::nullopt,
            a,
            b,
            span_.after ? number_of(*span_.after) : std::nullopt,
            span_.before ? ease(*span_.before, name) : KeyEase::smooth,
            ease(span_.b, name)};
  }

  // `whole`: what a key lacks is as those beside it have it; otherwise it is zero there.
  template <typename Value>
  Value one(const std::string& name, const Value& a, const Value& b, Named<Value> of, bool whole) const {
    if (!goes_by_spline(name)) return blend_of(a, b, share(name));
    const auto go = [&](double from, double to, const auto& number) {
      return spline_between(around(name, from, to,
                                   [&](const PoseKey& key) -> std::optional<double> {
                                     const auto found = (key.*of).find(name);
                                     if (found != (key.*of).end()) return number(found->second);
                                     return whole ? std::nullopt : std::optional(0.0);
                                   }),
                            span_);
    };
    if constexpr (std::is_same_v<Value, double>) {
      return go(a, b, [](double value) { return value; });
    } else {
      Value value;
      for (std::size_t i = 0; i < value.size(); ++i) {
        value[i] = go(a[i], b[i], [i](const Value& of_key) { return of_key[i]; });
      }
      return value;
    }
  }

  // What only the second has is nothing before the way begins.
  template <typename Value>
  std::map<std::string, Value> all(Named<Value> of, bool whole) const {
    const std::map<std::string, Value>&first = span_.a.*of, &second = span_.b.*of;
    std::map<std::string, Value> blended;
    for (const auto& [name, value] : first) {
      const auto other = second.find(name);
      blended[name] = one(name, value, other != second.end() ? other->second : whole ? value : Value{}, of, whole);
    }
    for (const auto& [name, value] : second) {
      if (share(name) > 0 && !first.contains(name))
        blended[name] = one(name, whole ? value : Value{}, value, of, whole);
    }
    return blended;
  }

  // A name that one side lacks keeps the other's turn.
  std::map<std::string, Vec3> facing() const {
    std::map<std::string, Vec3> blended = span_.a.facing;
    for (const auto& [name, degrees] : span_.b.facing) {
      if (share(name) <= 0) continue;
      const auto [at, is_new] = blended.emplace(name, degrees);
      if (!is_new) at->second = degrees_of(slerp(turn_of(at->second), turn_of(degrees), turned(name)));
    }
    return blended;
  }

  // The share of a turn. A spline goes on from the turn before, as far as that was about the same axis.
  double turned(const std::string& name) const {
    if (!goes_by_spline(name)) return share(name);
    const auto at = [&](const PoseKey& key) { return turn_of(key.facing.at(name)); };
    const Vec3 way = vector_of(conjugate(at(span_.a)) * at(span_.b));
    const double angle = length(way);
    if (angle < 1e-9) return share(name);
    const SplineValues values = around(name, 0, angle, [&](const PoseKey& key) -> std::optional<double> {
      if (!key.facing.contains(name)) return std::nullopt;
      return dot(vector_of(conjugate(at(span_.a)) * at(key)), way) / angle;
    });
    return spline_between(values, span_) / angle;
  }

  // The axis of a turn, as long as its angle, radians.
  static Vec3 vector_of(const Quat& turn) {
    const Vec3 axis{turn[0], turn[1], turn[2]};
    const double sine = length(axis);
    if (sine < 1e-12) return {};
    return (2 * std::atan2(turn[3] < 0 ? -sine : sine, std::abs(turn[3])) / sine) * axis;
  }

  const KeySpan<PoseKey> span_;
  const bool is_even_ = false;
};

// Returns what turns a joint's local rotation about an axis of rest space.
Quat turn_about_rest_axis(const Skeleton& skeleton, const trainer::JointTurn& turn, double degrees) {
  const int parent = skeleton.joints[turn.joint].parent;
  Vec3 axis = turn.axis;
  if (parent >= 0) axis = rotate(conjugate(bind_rotations(skeleton)[static_cast<std::size_t>(parent)]), axis);
  return axis_angle(axis, turn.share * degrees * std::numbers::pi / 180);
}

// Moves a joint along the world's axes, whatever is above it.
void move_joint(const Skeleton& skeleton, std::size_t joint, const Vec3& by, Pose& pose) {
  const int parent = skeleton.joints[joint].parent;
  Vec3& at = pose.joints[joint].translation;
  if (parent < 0) {
    at = at + by;
    return;
  }
  const Affine world = inverse(posed_joints(skeleton, pose.joints)[static_cast<std::size_t>(parent)]);
  at = at + (world * by - world * Vec3{});
}

// Returns the turn of a limb's end that a pose adds to its clip, about its own axes; a toe's includes its foot's.
Quat turned_here(const Skeleton& skeleton, std::size_t joint, const Pose& clip, const Pose& pose) {
  const auto own = [&](std::size_t j) { return conjugate(clip.joints[j].rotation) * pose.joints[j].rotation; };
  if (!ends_a_foot(skeleton, joint)) return own(joint);
  const Quat &before = clip.joints[joint].rotation, &now = pose.joints[joint].rotation;
  return conjugate(before) * own(static_cast<std::size_t>(skeleton.joints[joint].parent)) * now;
}

// Returns the angles of all degrees of freedom that turn the joint, radians away from rest. Gauss-Newton steps bring
// their turns, one after the other, nearest to the joint's.
std::map<const trainer::DegreeOfFreedom*, double> angles_at(const trainer::JointLimits& limits,
                                                            const Skeleton& skeleton, std::uint32_t joint,
                                                            const Pose& pose) {
  constexpr int kSteps = 10;
  std::vector<std::pair<const trainer::DegreeOfFreedom*, const trainer::JointTurn*>> turns;
  for (const trainer::DegreeOfFreedom& dof : limits.dofs) {
    for (const trainer::JointTurn& turn : dof.turns) {
      if (turn.joint == joint) turns.emplace_back(&dof, &turn);
    }
  }
  const Joint& own = skeleton.joints[joint];
  const Quat above = own.parent < 0 ? Quat{0, 0, 0, 1} : bind_rotations(skeleton)[static_cast<std::size_t>(own.parent)];
  const Quat wanted = above * normalized(pose.joints[joint].rotation) * conjugate(own.bind.rotation) * conjugate(above);
  const auto count = static_cast<Eigen::Index>(turns.size());
  Eigen::VectorXd angles = Eigen::VectorXd::Zero(count);
  for (int step = 0; step < kSteps; ++step) {
    Quat made{0, 0, 0, 1};
    Eigen::MatrixXd moved(3, count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const trainer::JointTurn& turn = *turns[static_cast<std::size_t>(k)].second;
      const Vec3 axis = turn.share * rotate(made, turn.axis);
      moved.col(k) << axis[0], axis[1], axis[2];
      made = made * axis_angle(turn.axis, turn.share * angles[k]);
    }
    Quat left = wanted * conjugate(made);
    if (left[3] < 0) left = {-left[0], -left[1], -left[2], -left[3]};
    const double sine = length({left[0], left[1], left[2]});
    const double scale = sine > 1e-12 ? 2 * std::atan2(sine, left[3]) / sine : 2;
    const Eigen::Vector3d missing = scale * Eigen::Vector3d(left[0], left[1], left[2]);
    const Eigen::MatrixXd damped = moved.transpose() * moved + 1e-6 * Eigen::MatrixXd::Identity(count, count);
    angles += damped.ldlt().solve(moved.transpose() * missing);
  }
  std::map<const trainer::DegreeOfFreedom*, double> by_dof;
  for (Eigen::Index k = 0; k < count; ++k) by_dof[turns[static_cast<std::size_t>(k)].first] = angles[k];
  return by_dof;
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

// Sets the pose's value for each of the names: that of the posing, where it has one.
void set_posed_controls(const std::vector<std::string>& names, const ViewSettings::PoseKey& posing, Pose& pose) {
  pose.controls.resize(names.size(), 0.0f);
  for (const auto& [name, value] : posing.controls) {
    const auto at = static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
    if (at < names.size()) pose.controls[at] = static_cast<float>(value);
  }
}

// The clip's pose as it is posed, before modifiers: with a value for each of the controls.
Pose posed_with_controls(const Skeleton& skeleton, const Turning& turning, const Pose& clip,
                         const ViewSettings::PoseKey& posing, const std::vector<std::string>& controls) {
  Pose pose = posed(skeleton, turning, clip, posing);
  set_posed_controls(controls, posing, pose);
  return pose;
}

// Controls alone steer modifiers: a breath goes on from frame to frame by them. Without keys, those set are keyed.
std::map<int, ViewSettings::PoseKey> control_keys(const ViewSettings::Posing& posing) {
  std::map<int, ViewSettings::PoseKey> keys;
  for (const auto& [frame, key] : posing.keys) {
    keys[frame] = {.controls = key.controls, .ease = key.ease, .eases = key.eases};
  }
  if (keys.empty()) keys[0] = {.controls = posing.controls};
  return keys;
}

// Returns the pose before limbs reach, and the pins for which they do.
std::pair<Pose, Pins> before_reaching(const Skeleton& skeleton, const Turning& turning, const Pose& clip,
                                      const ViewSettings::PoseKey& posing) {
  const auto& [limits, ranges] = turning;
  Pose pose = clip;
  for (const trainer::DegreeOfFreedom& dof : limits.dofs) {
    const auto found = posing.axes.find(dof.name);
    if (found == posing.axes.end()) continue;
    double degrees = found->second;
    if (!ranges.empty()) {
      const auto [low, high] = free_angles(limits, skeleton, dof, clip);
      degrees = std::clamp(degrees, low, high);
    }
    for (const trainer::JointTurn& turn : dof.turns) {
      Quat& rotation = pose.joints[turn.joint].rotation;
      rotation = turn_about_rest_axis(skeleton, turn, degrees) * rotation;
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
  for (const auto& [joint, by] : posing.moves) {
    const int found = skeleton.find(joint);
    if (found >= 0) move_joint(skeleton, static_cast<std::size_t>(found), by, pose);
  }
  Pins pins{posing.pins};
  for (const auto& [joint, degrees] : posing.facing) {
    const int found = skeleton.find(joint);
    if (found < 0) continue;
    pins.facing[joint] = turn_of(degrees) * turned_here(skeleton, static_cast<std::size_t>(found), clip, pose);
  }
  return {std::move(pose), std::move(pins)};
}

}  // namespace

ViewSettings::PoseKey blended(const ViewSettings::PoseKey& a, const ViewSettings::PoseKey& b, double t) {
  if (t >= 1) return b;  // what only the first has, as a pin, is no part of it
  return KeyBlend(a, b, t).pose();
}

ViewSettings::PoseKey eased_between(const KeySpan<ViewSettings::PoseKey>& span) { return KeyBlend(span).pose(); }

ViewSettings::Posing keyed_posing(ViewSettings::Posing posing, int frame) {
  if (!posing.keys.empty()) static_cast<ViewSettings::PoseKey&>(posing) = between_keys(posing.keys, frame);
  return posing;
}

std::pair<double, double> free_angles(const trainer::JointLimits& limits, const Skeleton& skeleton,
                                      const trainer::DegreeOfFreedom& dof, const Pose& clip) {
  double angle = 0;
  for (const trainer::JointTurn& turn : dof.turns) angle += angles_at(limits, skeleton, turn.joint, clip).at(&dof);
  angle *= 180 / std::numbers::pi / static_cast<double>(std::max<std::size_t>(1, dof.turns.size()));
  return {std::min(0.0, dof.min - dof.rest - angle), std::max(0.0, dof.max - dof.rest - angle)};
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

Turning turning_within(trainer::JointLimits limits, const Skeleton& skeleton) {
  std::vector<std::optional<JointRange>> ranges = joint_ranges(limits, skeleton);
  return {std::move(limits), std::move(ranges)};
}

Pose posed(const Skeleton& skeleton, const Turning& turning, const Pose& clip, const ViewSettings::PoseKey& posing) {
  auto [pose, pins] = before_reaching(skeleton, turning, clip, posing);
  return pinned(skeleton, turning.ranges, std::move(pose), pins);
}

std::vector<MissedPin> missed_pins(const Skeleton& skeleton, const Turning& turning, const Pose& clip,
                                   const ViewSettings::PoseKey& posing) {
  const auto [pose, pins] = before_reaching(skeleton, turning, clip, posing);
  return missed_pins(skeleton, turning.ranges, pose, pins);
}

Vec3 facing_of(const Skeleton& skeleton, const Turning& turning, const Pose& clip, const ViewSettings::PoseKey& posing,
               std::size_t joint) {
  const Pose free = before_reaching(skeleton, turning, clip, posing).first;
  const Quat shown = world_rotations(skeleton, posed(skeleton, turning, clip, posing))[joint];
  return degrees_of(shown * conjugate(turned_here(skeleton, joint, clip, free)));
}

ModifierState ModifierTrack::before(std::size_t at, const Clip& clip, const std::vector<std::string>& controls,
                                    const Basis& basis, const ViewSettings::Posing& posing) {
  constexpr std::size_t kTogether = 64;  // frames; to drive each by itself takes longer
  if (basis.modifiers.empty()) return {};
  std::map keys = control_keys(posing);
  if (basis_ != &basis || keys_ != keys || !std::ranges::is_permutation(controls_, controls)) {
    *this = {};
    basis_ = &basis;
    controls_ = controls;
    keys_ = std::move(keys);
  }
  auto known = std::prev(before_.upper_bound(at));
  while (known->first < at) {
    const auto first = clip.poses.begin() + static_cast<std::ptrdiff_t>(known->first);
    std::vector<Pose> poses(first, first + static_cast<std::ptrdiff_t>(std::min(kTogether, at - known->first)));
    for (std::size_t k = 0; k < poses.size(); ++k) {
      const int frame = clip.first_frame + static_cast<int>(known->first + k);
      set_posed_controls(controls_, between_keys(keys_, frame), poses[k]);
    }
    ModifierState state = known->second;
    drive_modifiers(basis, controls_, clip.fps, poses, &state);
    known = before_.emplace(known->first + poses.size(), std::move(state)).first;
  }
  return known->second;
}

Pose posed_frame(const Clip& clip, std::size_t at, const Basis& basis, const Turning& turning,
                 const ViewSettings::Posing& posing, ModifierTrack& track) {
  Clip frame;
  frame.fps = clip.fps;
  frame.controls = posed_controls(clip, posing);
  frame.poses.push_back(posed_with_controls(basis.skeleton, turning, clip.poses[at], posing, frame.controls));
  ModifierState state = track.before(at, clip, frame.controls, basis, posing);
  apply_channels(basis, frame, &state);
  return std::move(frame.poses.front());
}

Clip posed_clip(Clip clip, const Skeleton& skeleton, const Turning& turning, const ViewSettings::Posing& posing) {
  const std::vector<std::string> controls = posed_controls(clip, posing);
  for (std::size_t k = 0; k < clip.poses.size(); ++k) {
    const ViewSettings::Posing here = keyed_posing(posing, clip.first_frame + static_cast<int>(k));
    clip.poses[k] = posed_with_controls(skeleton, turning, clip.poses[k], here, controls);
  }
  clip.controls = controls;
  return clip;
}

}  // namespace bodyopt::shots
