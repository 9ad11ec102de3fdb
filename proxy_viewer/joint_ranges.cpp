#include "proxy_viewer/joint_ranges.h"

#include <algorithm>
#include <cmath>

namespace bodyopt {
namespace {

// World to the joint's own axes, in the bind pose.
Vec3 own_axis(const Joint& joint, const Vec3& axis) { return rotate(decompose(joint.inverse_bind).rotation, axis); }

constexpr double kAcross = 0.2;  // an axis of which a turn has less than this is not turned about

}  // namespace

void limit_joints(const JointLimits& limits, const Skeleton& skeleton, std::vector<JointRow>& rows) {
  std::vector<bool> is_held(rows.size(), false);
  for (const DegreeOfFreedom& dof : limits.dofs) {
    for (const JointTurn& turn : dof.turns) {
      const Joint& joint = skeleton.joints[turn.joint];
      if (joint.parent < 0) continue;
      JointRow& row = rows[turn.joint];
      if (!is_held[turn.joint]) row.low = row.high = {};
      is_held[turn.joint] = true;
      const Vec3 direction = own_axis(joint, turn.axis);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (std::abs(direction[axis]) < kAcross) continue;
        const double part = direction[axis] * turn.share;
        const auto [low, high] = std::minmax({part * (dof.min - dof.rest), part * (dof.max - dof.rest)});
        row.low[axis] = std::min(row.low[axis], low);
        row.high[axis] = std::max(row.high[axis], high);
      }
    }
  }
}

}  // namespace bodyopt
