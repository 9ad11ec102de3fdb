#include "runtime/modifiers/fold_bend.h"

#include <algorithm>
#include <cmath>

namespace bodyopt {
namespace {

double turn_of(const Skeleton& skeleton, const Pose& pose, std::size_t joint) {
  const Quat turn = conjugate(skeleton.joints[joint].bind.rotation) * normalized(pose.joints[joint].rotation);
  return 2 * std::atan2(std::hypot(turn[0], turn[1], turn[2]), std::abs(turn[3]));
}

}  // namespace

double fold_bend(const Skeleton& skeleton, const Pose& pose, std::uint32_t joint) {
  double of_children = 0;
  for (std::size_t child = joint + 1; child < skeleton.size(); ++child) {
    if (skeleton.joints[child].parent != static_cast<int>(joint)) continue;
    of_children = std::max(of_children, turn_of(skeleton, pose, child));
  }
  const int parent = skeleton.joints[joint].parent;
  const double of_parent = parent < 0 ? 0 : turn_of(skeleton, pose, static_cast<std::size_t>(parent));
  return turn_of(skeleton, pose, joint) + of_parent + of_children;
}

}  // namespace bodyopt
