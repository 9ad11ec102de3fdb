#include "runtime/modifiers/world_rotations.h"

namespace bodyopt {

std::vector<Quat> world_rotations(const Skeleton& skeleton, const Pose& pose) {
  std::vector<Quat> world;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    const Quat own = normalized(pose.joints[j].rotation);
    world.push_back(parent < 0 ? own : world[static_cast<std::size_t>(parent)] * own);
  }
  return world;
}

}  // namespace bodyopt
