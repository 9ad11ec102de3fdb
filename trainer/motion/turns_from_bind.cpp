#include "trainer/motion/turns_from_bind.h"

#include "runtime/host/rig.h"

namespace bodyopt {

std::vector<Quat> turns_from_bind(const Skeleton& skeleton, const std::vector<Pose>& poses, std::size_t joint) {
  const Quat world = bind_rotations(skeleton)[joint];
  const Quat to_bind = world * conjugate(normalized(skeleton.joints[joint].bind.rotation));
  std::vector<Quat> turns;
  for (const Pose& pose : poses) {
    turns.push_back(normalized(to_bind * normalized(pose.joints[joint].rotation) * conjugate(world)));
  }
  return turns;
}

Vec3 length_of_bone(const Skeleton& skeleton, std::size_t joint) {
  const std::vector<Affine> bind = posed_joints(skeleton, bind_pose(skeleton).joints);
  const auto at = [&](std::size_t j) { return bind[j] * Vec3{0, 0, 0}; };
  Vec3 sum{0, 0, 0};
  double count = 0;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    if (skeleton.joints[j].parent != static_cast<int>(joint)) continue;
    sum = sum + (at(j) - at(joint));
    ++count;
  }
  return (count > 0 ? 1 / count : 0) * sum;
}

}  // namespace bodyopt
