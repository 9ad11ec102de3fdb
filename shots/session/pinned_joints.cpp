#include "shots/session/pinned_joints.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/host/rig.h"
#include "runtime/modifiers/drive_modifiers.h"

namespace bodyopt {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

double sum(const Vec3& angles) { return std::abs(angles[0]) + std::abs(angles[1]) + std::abs(angles[2]); }

// Half a turn about x and z, and y from the other side, is the same turn.
Vec3 other_angles(const Vec3& degrees) {
  return {std::remainder(degrees[0] + 180, 360), std::remainder(180 - degrees[1], 360),
          std::remainder(degrees[2] + 180, 360)};
}

// At x = 0: an axis is reflected, and the sense of turning as well.
Quat reflected(const Quat& turn) { return {turn[0], -turn[1], -turn[2], turn[3]}; }

// World to the joint's own axes, in the bind pose.
Vec3 own_axis(const Joint& joint, const Vec3& axis) { return rotate(decompose(joint.inverse_bind).rotation, axis); }

constexpr double kAcross = 0.2;  // an axis of which a turn has less than this is not turned about

// With what the clip has beyond it.
JointRange with_clip(JointRange range, const Vec3& angles) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    range.low[axis] = std::min(range.low[axis], angles[axis]);
    range.high[axis] = std::max(range.high[axis], angles[axis]);
  }
  return range;
}

constexpr double kTiny = 1e-9;

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(length(cross(a, b)), dot(a, b)); }

Vec3 any_across(const Vec3& along) {
  const Vec3 other = std::abs(along[0]) < 0.5 * length(along) ? Vec3{1, 0, 0} : Vec3{0, 0, 1};
  const Vec3 across = cross(along, other);
  return 1 / std::max(kTiny, length(across)) * across;
}

Quat swing(const Vec3& from, const Vec3& to) {
  const Vec3 across = cross(from, to);
  const double size = length(across), angle = angle_between(from, to);
  if (angle < kTiny) return {0, 0, 0, 1};
  return axis_angle(size > kTiny * length(from) * length(to) ? 1 / size * across : any_across(from), angle);
}

Vec3 centre(const Affine& joint) { return joint * Vec3{0, 0, 0}; }

class Limb {
 public:
  Limb(const Skeleton& skeleton, const std::vector<std::optional<JointRange>>& ranges, Pose& pose, std::size_t end)
      : skeleton_(skeleton), ranges_(ranges), pose_(pose), end_(end), middle_(parent(end)), upper_(parent(middle_)) {}

  void reach_for(const Vec3& target) {
    const Quat held = rotations()[end_];
    const std::vector<Affine> joints = posed_joints(skeleton_, pose_.joints);
    const Vec3 a = centre(joints[upper_]), b = centre(joints[middle_]), c = centre(joints[end_]);
    turn(middle_, reach(a, b, c, target, any_across(c - a)).lower);
    // What the range has left of the bend is swung to the target.
    const Vec3 bent = centre(posed_joints(skeleton_, pose_.joints)[end_]);
    turn(upper_, swing(bent - a, target - a));
    turn(end_, held * conjugate(rotations()[end_]));
  }

 private:
  std::size_t parent(std::size_t joint) const { return static_cast<std::size_t>(skeleton_.joints[joint].parent); }
  std::vector<Quat> rotations() const { return world_rotations(skeleton_, pose_); }

  // By a rotation of the world, as far as the joint's range lets it.
  void turn(std::size_t joint, const Quat& by) {
    const std::vector<Quat> world = rotations();
    const int above = skeleton_.joints[joint].parent;
    const Quat turned = by * world[joint];
    Quat local = normalized(above < 0 ? turned : conjugate(world[static_cast<std::size_t>(above)]) * turned);
    const Quat& bind = skeleton_.joints[joint].bind.rotation;
    if (joint < ranges_.size() && ranges_[joint]) {
      local = turned_within(*ranges_[joint], bind, bind, degrees_of(conjugate(bind) * local));
    }
    pose_.joints[joint].rotation = local;
  }

  const Skeleton& skeleton_;
  const std::vector<std::optional<JointRange>>& ranges_;
  Pose& pose_;
  const std::size_t end_, middle_, upper_;
};

}  // namespace

Quat turn_of(const Vec3& degrees) {
  return axis_angle({0, 0, 1}, kDegree * degrees[2]) * axis_angle({0, 1, 0}, kDegree * degrees[1]) *
         axis_angle({1, 0, 0}, kDegree * degrees[0]);
}

Vec3 degrees_of(const Quat& turn) {
  constexpr double kUpright = 1 - 1e-12;  // sine of y: x and z turn about the same axis, and z takes all of it
  const auto m = rotation_matrix(turn);
  const double sine = std::clamp(-m[2][0], -1.0, 1.0);
  Vec3 radians{0, std::asin(sine), 0};
  if (std::abs(sine) < kUpright) {
    radians[0] = std::atan2(m[2][1], m[2][2]);
    radians[2] = std::atan2(m[1][0], m[0][0]);
  } else {
    radians[2] = std::atan2(-m[0][1], m[1][1]);
  }
  const Vec3 degrees = (1 / kDegree) * radians, other = other_angles(degrees);
  return sum(other) < sum(degrees) ? other : degrees;
}

Vec3 mirrored_angles(const Vec3& degrees, const Quat& axes, const Quat& other_axes) {
  const Quat in_world = axes * turn_of(degrees) * conjugate(axes);
  return degrees_of(conjugate(other_axes) * reflected(in_world) * other_axes);
}

std::vector<std::optional<JointRange>> joint_ranges(const JointLimits& limits, const Skeleton& skeleton) {
  std::vector<std::optional<JointRange>> ranges(skeleton.size());
  for (const DegreeOfFreedom& dof : limits.dofs) {
    for (const JointTurn& turn : dof.turns) {
      const Joint& joint = skeleton.joints[turn.joint];
      if (joint.parent < 0) continue;
      std::optional<JointRange>& found = ranges[turn.joint];
      if (!found) found.emplace();
      const Vec3 direction = own_axis(joint, turn.axis);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (std::abs(direction[axis]) < kAcross) continue;
        const double part = direction[axis] * turn.share;
        const auto [low, high] = std::minmax({part * (dof.min - dof.rest), part * (dof.max - dof.rest)});
        found->low[axis] = std::min(found->low[axis], low);
        found->high[axis] = std::max(found->high[axis], high);
      }
    }
  }
  return ranges;
}

Quat turned_within(const JointRange& range, const Quat& bind, const Quat& clip, const Vec3& degrees) {
  if (degrees == Vec3{}) return normalized(clip);
  const Vec3 before = degrees_of(conjugate(bind) * clip);
  const JointRange allowed = with_clip(range, before);
  Vec3 within;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    within[axis] = std::clamp(before[axis] + degrees[axis], allowed.low[axis], allowed.high[axis]);
  }
  return normalized(bind * turn_of(within));
}

JointRange turns_within(const JointRange& range, const Quat& bind, const Quat& clip) {
  const Vec3 before = degrees_of(conjugate(bind) * clip);
  const JointRange allowed = with_clip(range, before);
  return {allowed.low - before, allowed.high - before};
}

LimbTurns reach(const Vec3& upper, const Vec3& middle, const Vec3& end, const Vec3& target, const Vec3& hinge) {
  const double above = length(middle - upper), below = length(end - middle);
  const double away = std::clamp(length(target - upper), std::abs(above - below), above + below);
  const double cosine = (above * above + below * below - away * away) / std::max(kTiny * kTiny, 2 * above * below);
  const Vec3 plane = cross(middle - upper, end - middle);
  const bool is_straight = length(plane) <= 1e-6 * above * below;
  const double bend = angle_between(upper - middle, end - middle) - std::acos(std::clamp(cosine, -1.0, 1.0));
  const Quat lower = axis_angle(is_straight ? hinge : 1 / length(plane) * plane, bend);
  const Vec3 bent = middle + rotate(lower, end - middle);
  return {lower, swing(bent - upper, target - upper)};
}

std::vector<MissedPin> missed_pins(const Skeleton& skeleton, const std::vector<std::optional<JointRange>>& ranges,
                                   const Pose& pose, const std::map<std::string, Vec3>& pins) {
  constexpr double kMissed = 1e-3;  // metres
  if (pins.empty()) return {};
  const std::vector<Affine> held = posed_joints(skeleton, pinned(skeleton, ranges, pose, pins).joints),
                            free = posed_joints(skeleton, pinned(skeleton, {}, pose, pins).joints);
  std::vector<MissedPin> missed;
  for (const auto& [joint, pin] : pins) {
    const int found = skeleton.find(joint);
    if (found < 0) continue;
    const auto j = static_cast<std::size_t>(found);
    const double by = length(centre(held[j]) - pin);
    if (by > kMissed) missed.push_back({joint, by, length(centre(free[j]) - pin) < by - kMissed});
  }
  return missed;
}

bool ends_a_limb(const Skeleton& skeleton, const std::string& joint) {
  const int found = skeleton.find(joint);
  const int above = found < 0 ? -1 : skeleton.joints[static_cast<std::size_t>(found)].parent;
  return above >= 0 && skeleton.joints[static_cast<std::size_t>(above)].parent >= 0;
}

Pose pinned(const Skeleton& skeleton, const std::vector<std::optional<JointRange>>& ranges, Pose pose,
            const std::map<std::string, Vec3>& pins) {
  for (const auto& [joint, target] : pins) {
    if (!ends_a_limb(skeleton, joint)) continue;
    Limb(skeleton, ranges, pose, static_cast<std::size_t>(skeleton.find(joint))).reach_for(target);
  }
  return pose;
}

}  // namespace bodyopt
