#include "proxy_viewer/state/joint_ranges.h"

#include <algorithm>
#include <cmath>

#include "proxy_viewer/state/euler_angles.h"

namespace bodyopt {
namespace {

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
