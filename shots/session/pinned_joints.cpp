#include "shots/session/pinned_joints.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "assets/clips/joint_roles.h"
#include "runtime/core/text.h"
#include "runtime/host/rig.h"
#include "runtime/modifiers/drive_modifiers.h"
#include "shots/session/view_settings.h"

namespace bodyopt::shots {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

double sum(const Vec3& angles) { return std::abs(angles[0]) + std::abs(angles[1]) + std::abs(angles[2]); }

// Half a turn about x and z, and y from the other side, is the same turn.
Vec3 other_angles(const Vec3& degrees) {
  return {std::remainder(degrees[0] + 180, 360), std::remainder(180 - degrees[1], 360),
          std::remainder(degrees[2] + 180, 360)};
}

// Mirrors a turn at x = 0: its axis is reflected, and the sense of turning as well.
Quat reflected(const Quat& turn) { return {turn[0], -turn[1], -turn[2], turn[3]}; }

// World to the joint's own axes, in the bind pose.
Vec3 own_axis(const Joint& joint, const Vec3& axis) { return rotate(decompose(joint.inverse_bind).rotation, axis); }

constexpr double kAcross = 0.2;  // an axis of which a turn has less than this is not turned about

// Widens the range by what the clip has beyond it.
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

constexpr double kShort = 0.6;  // of the bone above

// Metres, from the joint above; 0: it is a root.
double bone_length(const Skeleton& skeleton, std::size_t joint) {
  const int above = skeleton.joints[joint].parent;
  if (above < 0) return 0;
  return length(bind_place(skeleton, joint) - bind_place(skeleton, static_cast<std::size_t>(above)));
}

// Heights of the joints in the bind pose, as it stands in the world, over the lowest of them.
std::vector<double> heights(const Skeleton& skeleton) {
  std::vector<double> over;
  for (const Affine& joint : posed_joints(skeleton, bind_pose(skeleton).joints)) over.push_back(centre(joint)[1]);
  const double lowest = std::ranges::min(over);
  for (double& height : over) height -= lowest;
  return over;
}

// Is the end near the ground beside the root of its limb, as a foot is, and a hand or a knee is not?
bool stands(const Skeleton& skeleton, std::size_t end) {
  constexpr double kLow = 0.4;  // of the height of the limb's root
  const std::vector<double> height = heights(skeleton);
  const auto middle = static_cast<std::size_t>(skeleton.joints[end].parent);
  return height[end] < kLow * height[static_cast<std::size_t>(skeleton.joints[middle].parent)];
}

// Returns the toe on which a foot may stand without its heel: of several that on the longest bone. None: it has none.
std::optional<std::size_t> toe_of(const Skeleton& skeleton, std::size_t foot) {
  if (!stands(skeleton, foot)) return std::nullopt;
  const std::vector<double> height = heights(skeleton);
  std::optional<std::size_t> toe;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    if (skeleton.joints[j].parent != static_cast<int>(foot) || height[j] >= height[foot]) continue;
    if (!toe || bone_length(skeleton, j) > bone_length(skeleton, *toe)) toe = j;
  }
  return toe;
}

using Roles = std::vector<std::optional<JointRole>>;

bool is_of_spine(const Roles& roles, std::size_t joint) {
  const std::optional<JointRole>& role = roles[joint];
  return role && (role->part == BodyPart::spine || role->part == BodyPart::neck || role->part == BodyPart::head);
}

// Joints of a spine above one of it, from the hips on; none: it is of no spine.
std::vector<std::size_t> spine_above(const Skeleton& skeleton, const Roles& roles, std::size_t joint) {
  std::vector<std::size_t> chain;
  if (!is_of_spine(roles, joint)) return chain;
  for (int at = skeleton.joints[joint].parent; at >= 0 && is_of_spine(roles, static_cast<std::size_t>(at));) {
    chain.insert(chain.begin(), static_cast<std::size_t>(at));
    at = skeleton.joints[chain.front()].parent;
  }
  return chain;
}

constexpr double kReached = 1e-6, kMissed = 1e-3;  // metres: it is there; somebody is told

class Limb {
 public:
  Limb(const Skeleton& skeleton, const std::vector<std::optional<JointRange>>& ranges, Pose& pose, std::size_t end)
      : skeleton_(skeleton), ranges_(ranges), pose_(pose), end_(end), middle_(parent(end)), upper_(parent(middle_)) {}

  // The end has an orientation `held`, within its range. Ranges may cut the bend short and leave the limb too long or
  // too short. Then it is bent again from there, for as long as that helps.
  void reach_for(const Vec3& target, const Quat& held) {
    constexpr int kTries = 16;
    bend_as_it_may();
    double before = std::numeric_limits<double>::infinity();
    for (int k = 0; k < kTries; ++k) {
      const Pose nearest = pose_;
      bend_and_swing(target);
      const double away = length(place(end_) - target);
      if (away >= before) pose_ = nearest;
      if (away >= before || away < kReached) break;
      before = away;
    }
    face(held);
  }

  void bend_and_swing(const Vec3& target) {
    const std::vector<Affine> joints = posed_joints(skeleton_, pose_.joints);
    const Vec3 a = centre(joints[upper_]), b = centre(joints[middle_]), c = centre(joints[end_]);
    turn(middle_, reach(a, b, c, target, hinge().value_or(any_across(c - a))).lower);
    // The upper joint swings towards the target whatever the range has left of the bend.
    turn(upper_, swing(place(end_) - a, target - a));
  }

  // Turns the end itself, within its range.
  void face(const Quat& to) { turn(end_, to * conjugate(rotations()[end_])); }

  // All joints of a chain above the end turn, as little in sum as brings it there; the end keeps its orientation. Least
  // squares, damped by what is missing. The end is led there in small steps: a long one would go beyond, and leave the
  // chain as it happens to fall.
  void bend_chain(const std::vector<std::size_t>& chain, const Vec3& target) {
    constexpr int kSteps = 40, kLed = 28;
    const Quat held = rotations()[end_];
    const Vec3 from = place(end_), way = within_reach(chain, target) - from;
    for (int step = 1; step <= kSteps; ++step) {
      const std::vector<Affine> joints = posed_joints(skeleton_, pose_.joints);
      const Vec3 end = centre(joints[end_]),
                 missing = from + std::min(1.0, static_cast<double>(step) / kLed) * way - end;
      if (length(missing) < kTiny) continue;
      Eigen::Matrix3d moved = Eigen::Matrix3d::Zero();
      double longest = 0;
      std::vector<Eigen::Vector3d> levers;
      for (const std::size_t joint : chain) {
        const Vec3 lever = end - centre(joints[joint]);
        levers.emplace_back(lever[0], lever[1], lever[2]);
        moved += levers.back().squaredNorm() * Eigen::Matrix3d::Identity() - levers.back() * levers.back().transpose();
        longest = std::max(longest, length(lever));
      }
      moved += length(missing) * std::max(kTiny, longest) * Eigen::Matrix3d::Identity();
      const Eigen::Vector3d pull = moved.ldlt().solve(Eigen::Vector3d(missing[0], missing[1], missing[2]));
      for (std::size_t k = 0; k < chain.size(); ++k) {
        const Eigen::Vector3d turned = levers[k].cross(pull);
        const double angle = turned.norm();
        if (angle > kTiny) turn(chain[k], axis_angle(1 / angle * Vec3{turned[0], turned[1], turned[2]}, angle));
      }
    }
    face(held);
  }

  // Returns the nearest point to a target that a chain reaches without a jump: not stretched to its end, nor folded
  // onto its base. These points are a convex body, so that a small step of the target is a small step of its nearest
  // point.
  Vec3 within_reach(const std::vector<std::size_t>& chain, const Vec3& target) const {
    constexpr double kStretched = 0.985, kFolded = 0.25;  // of the chain's length
    const Vec3 base = place(chain.front()), axis = place(end_) - base;
    double longest = 0;
    for (std::size_t k = 0; k < chain.size(); ++k) {
      longest += length(place(k + 1 < chain.size() ? chain[k + 1] : end_) - place(chain[k]));
    }
    const double own = length(axis), most = std::max(own, kStretched * longest),
                 least = std::min(0.5 * own, kFolded * longest);
    if (own < kTiny) return target;
    const Vec3 up = 1 / own * axis;
    Vec3 by = target - base;
    const double along = dot(by, up), size = length(by);
    const Vec3 across = by - along * up;
    // The ball's point, or the foot on the plane that cuts it, or their common circle's.
    if (size > most) by = most / size * by;
    if (dot(by, up) < least) {
      const double wide = length(across), widest = std::sqrt(most * most - least * least);
      by = least * up + std::min(1.0, widest / std::max(kTiny, wide)) * across;
    }
    return base + by;
  }

  // Brings a joint under the end to the target; the end has an orientation `held` as far as its range lets it. A limb
  // that is too short turns it: the heel comes up. So does one that cannot fold so far, where `folds`. Under that the
  // toe itself stays flat.
  void hold(std::size_t toe, const Vec3& target, Quat held, bool folds) {
    constexpr int kTries = 12;
    const Quat flat = held * pose_.joints[toe].rotation;
    for (int k = 0; k < kTries; ++k) {
      const Vec3 end = target - (place(toe) - place(end_)), upper = place(upper_);
      reach_for(end, held);
      if (length(place(toe) - target) < kReached) break;
      const double longer = length(end - upper) - length(place(end_) - upper);
      if (folds ? length(end - place(end_)) < kReached : longer < kReached) continue;
      aim(toe, target);
      held = rotations()[end_];
    }
    turn(toe, flat * conjugate(rotations()[toe]));
  }

  // Brings the end to the target. Where its range does not let it have the orientation, and its toe would sink, the toe
  // stays as high as that would put it, and the heel comes up.
  void plant(std::size_t toe, const Vec3& target, const Quat& held) {
    constexpr double kLetGo = 0.01;  // metres
    const Vec3 flat = rotate(held * conjugate(rotations()[end_]), place(toe) - place(end_));
    reach_for(target, held);
    const Vec3 sole = place(toe) - place(end_);
    const double sunk = flat[1] - sole[1];
    if (sunk < kReached) return;
    // What turns the foot about the vertical stays; it is let go of what tips it as it begins to sink.
    const Quat tip = rotations()[end_] * conjugate(held);
    const Vec3 level = rotate(normalized({0, tip[1], 0, tip[3]}), flat);
    const double share = std::min(1.0, sunk / kLetGo);
    const Vec3 stays = sole + share * (level - sole);
    hold(toe, target + Vec3{stays[0], flat[1], stays[2]}, held, false);
  }

  // Turns the end so that a joint under it is seen in the direction of the target.
  void aim(std::size_t toe, const Vec3& target) {
    const Vec3 from = place(end_);
    turn(end_, swing(place(toe) - from, target - from));
  }

 private:
  std::size_t parent(std::size_t joint) const { return static_cast<std::size_t>(skeleton_.joints[joint].parent); }
  std::vector<Quat> rotations() const { return world_rotations(skeleton_, pose_); }
  Vec3 place(std::size_t joint) const { return centre(posed_joints(skeleton_, pose_.joints)[joint]); }

  // Returns the world axis of a middle joint that bends to one side alone; none: it bends any way, or is unknown.
  std::optional<Vec3> hinge() const {
    constexpr double kOneSided = 0.25;  // of the bend, what goes to the other side
    if (middle_ >= ranges_.size() || !ranges_[middle_]) return std::nullopt;
    const JointRange& range = *ranges_[middle_];
    Vec3 axis{};
    double widest = 0;
    bool is_one_sided = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const double most = std::max(range.high[k], -range.low[k]), least = std::min(range.high[k], -range.low[k]);
      if (most <= widest) continue;
      widest = most;
      axis = {};
      axis[k] = range.high[k] > -range.low[k] ? 1 : -1;
      is_one_sided = least < kOneSided * most;
    }
    if (!is_one_sided) return std::nullopt;
    return rotate(rotations()[middle_], axis);
  }

  // A knee that is bent a little to the wrong side is bent as much to the right one, where it may go on.
  void bend_as_it_may() {
    const std::optional<Vec3> axis = hinge();
    if (!axis) return;
    const Vec3 above = place(middle_) - place(upper_), below = place(end_) - place(middle_);
    const Vec3 plane = cross(above, below);
    if (dot(plane, *axis) < 0) turn(middle_, axis_angle(1 / length(plane) * plane, -2 * angle_between(above, below)));
  }

  // Rotates a joint in the world, as far as its range lets it.
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

// Bends spines from the hips upwards, before limbs reach. Pinned joints of a chain, and those above them, stay.
void bend_spine(const Skeleton& skeleton, const std::vector<std::optional<JointRange>>& ranges, const Roles& roles,
                Pose& pose, const Pins& pins) {
  for (std::size_t end = 0; end < skeleton.size(); ++end) {
    const std::string& name = skeleton.joints[end].name;
    const auto pin = pins.at.find(name);
    if (pin == pins.at.end()) continue;
    std::vector<std::size_t> chain = spine_above(skeleton, roles, end);
    const auto held = std::ranges::find_if(
        chain.rbegin(), chain.rend(), [&](std::size_t joint) { return pins.at.contains(skeleton.joints[joint].name); });
    chain.erase(chain.begin(), held.base());
    if (chain.empty()) continue;
    Limb spine(skeleton, ranges, pose, end);
    if (const auto facing = pins.facing.find(name); facing != pins.facing.end()) spine.face(facing->second);
    spine.bend_chain(chain, pin->second);
  }
}

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

std::vector<std::optional<JointRange>> joint_ranges(const trainer::JointLimits& limits, const Skeleton& skeleton) {
  std::vector<std::optional<JointRange>> ranges(skeleton.size());
  for (const trainer::DegreeOfFreedom& dof : limits.dofs) {
    for (const trainer::JointTurn& turn : dof.turns) {
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
                                   const Pose& pose, const Pins& pins) {
  constexpr double kTipped = 1;  // degrees
  if (pins.at.empty()) return {};
  const Pose within = pinned(skeleton, ranges, pose, pins);
  const std::vector<Affine> held = posed_joints(skeleton, within.joints),
                            free = posed_joints(skeleton, pinned(skeleton, {}, pose, pins).joints);
  const std::vector<Quat> before = world_rotations(skeleton, pose), facing = world_rotations(skeleton, within);
  std::vector<MissedPin> missed;
  for (const auto& [joint, pin] : pins.at) {
    const int found = skeleton.find(joint);
    if (found < 0) continue;
    const auto j = static_cast<std::size_t>(found);
    MissedPin miss{.joint = joint, .away = length(centre(held[j]) - pin)};
    miss.by_limits = length(centre(free[j]) - pin) < miss.away - kMissed;
    if (ends_a_limb(skeleton, joint) && stands(skeleton, j)) {
      const Quat tip = set_or(pins.facing, joint, before[j]) * conjugate(facing[j]);
      const std::optional<std::size_t> toe = toe_of(skeleton, j);
      const double flat = toe ? pin[1] + rotate(tip, centre(held[*toe]) - centre(held[j]))[1] : 0;
      miss.on_toes = toe && miss.by_limits && std::abs(centre(held[*toe])[1] - flat) < kMissed;
      const bool is_sole = !toe && !ends_a_foot(skeleton, j);
      if (is_sole) miss.tipped = angle_between(rotate(tip, {0, 1, 0}), {0, 1, 0}) / kDegree;
    }
    if (miss.away > kMissed || miss.tipped > kTipped) missed.push_back(miss);
  }
  return missed;
}

bool ends_a_foot(const Skeleton& skeleton, std::size_t joint) {
  const auto above = static_cast<std::size_t>(std::max(0, skeleton.joints[joint].parent));
  if (!ends_a_limb(skeleton, skeleton.joints[above].name)) return false;
  const double lower = bone_length(skeleton, above),
               upper = bone_length(skeleton, static_cast<std::size_t>(skeleton.joints[above].parent));
  return bone_length(skeleton, joint) < kShort * lower && lower >= kShort * upper && !is_on_spine(skeleton, joint);
}

bool is_on_spine(const Skeleton& skeleton, std::size_t joint) {
  return !spine_above(skeleton, joint_roles(named_joints(skeleton)), joint).empty();
}

std::string describe(const MissedPin& pin) {
  const char* const why = pin.by_limits ? "held by joint limits" : "out of reach";
  if (pin.on_toes) return pin.joint + formatted(": its heel is up by %.0f mm, %s", 1e3 * pin.away, why);
  if (pin.away < kMissed) return pin.joint + formatted(": tipped by %.0f degrees, held by joint limits", pin.tipped);
  return pin.joint + formatted(": %.0f mm from its pin, %s", 1e3 * pin.away, why);
}

bool ends_a_limb(const Skeleton& skeleton, const std::string& joint) {
  const int found = skeleton.find(joint);
  const int above = found < 0 ? -1 : skeleton.joints[static_cast<std::size_t>(found)].parent;
  return above >= 0 && skeleton.joints[static_cast<std::size_t>(above)].parent >= 0;
}

Pose pinned(const Skeleton& skeleton, const std::vector<std::optional<JointRange>>& ranges, Pose pose,
            const Pins& pins) {
  if (pins.at.empty()) return pose;
  const Roles roles = joint_roles(named_joints(skeleton));
  bend_spine(skeleton, ranges, roles, pose, pins);
  std::vector<std::size_t> toes;
  for (const auto& [joint, target] : pins.at) {
    if (!ends_a_limb(skeleton, joint)) continue;
    const auto end = static_cast<std::size_t>(skeleton.find(joint));
    if (!spine_above(skeleton, roles, end).empty()) continue;
    if (ends_a_foot(skeleton, end)) {
      toes.push_back(end);
      continue;
    }
    Limb limb(skeleton, ranges, pose, end);
    const Quat held = set_or(pins.facing, joint, world_rotations(skeleton, pose)[end]);
    if (const std::optional<std::size_t> toe = toe_of(skeleton, end)) {
      limb.plant(*toe, target, held);
    } else {
      limb.reach_for(target, held);
    }
  }
  // Toes follow once feet are where they are pinned themselves.
  for (const std::size_t toe : toes) {
    const std::string& name = skeleton.joints[toe].name;
    const auto foot = static_cast<std::size_t>(skeleton.joints[toe].parent);
    Limb limb(skeleton, ranges, pose, foot);
    if (pins.at.contains(skeleton.joints[foot].name)) {
      limb.aim(toe, pins.at.at(name));
      continue;
    }
    const Quat flat = set_or(pins.facing, name, world_rotations(skeleton, pose)[toe]);
    limb.hold(toe, pins.at.at(name), flat * conjugate(pose.joints[toe].rotation), true);
  }
  return pose;
}

}  // namespace bodyopt::shots
