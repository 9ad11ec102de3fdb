#include "shots/session/joint_ranges.h"

#include <algorithm>
#include <cmath>
#include <numbers>

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

}  // namespace bodyopt
