#include "runtime/modifiers/joint_turns.h"

#include <cmath>

namespace bodyopt {
namespace {

Vec3 turn_vector(const Quat& turn) {
  const Vec3 axis{turn[0], turn[1], turn[2]};
  const double sine = length(axis);
  if (!(sine > 0)) return {0, 0, 0};
  const double angle = 2 * std::atan2(sine, std::abs(turn[3]));
  return (turn[3] < 0 ? -angle : angle) / sine * axis;
}

}  // namespace

std::vector<Quat> world_rotations(const Skeleton& skeleton, const std::vector<Quat>& local) {
  std::vector<Quat> world;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    const Quat own = normalized(local[j]);
    world.push_back(parent < 0 ? own : world[static_cast<std::size_t>(parent)] * own);
  }
  return world;
}

std::vector<Quat> bind_world_rotations(const Skeleton& skeleton) {
  std::vector<Quat> local;
  for (const Joint& joint : skeleton.joints) local.push_back(joint.bind.rotation);
  return world_rotations(skeleton, local);
}

std::vector<Vec3> rest_turns(const Skeleton& skeleton, const Pose& pose) {
  const std::vector<Quat> bind = bind_world_rotations(skeleton);
  std::vector<Vec3> turns;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const Joint& joint = skeleton.joints[j];
    const Quat parent = joint.parent < 0 ? Quat{0, 0, 0, 1} : bind[static_cast<std::size_t>(joint.parent)];
    const Quat own = normalized(pose.joints[j].rotation) * conjugate(normalized(joint.bind.rotation));
    turns.push_back(turn_vector(parent * own * conjugate(parent)));
  }
  return turns;
}

std::vector<Vec3> fold_bends(const Skeleton& skeleton, const Pose& pose) {
  const std::vector<Vec3> turns = rest_turns(skeleton, pose);
  std::vector<Vec3> bends = turns, of_children(turns.size(), Vec3{0, 0, 0});
  for (std::size_t j = 0; j < turns.size(); ++j) {
    if (skeleton.joints[j].parent < 0) continue;
    const auto parent = static_cast<std::size_t>(skeleton.joints[j].parent);
    if (skeleton.joints[parent].parent >= 0) bends[j] = bends[j] + turns[parent];
    if (length(turns[j]) > length(of_children[parent])) of_children[parent] = turns[j];
  }
  for (std::size_t j = 0; j < turns.size(); ++j) bends[j] = bends[j] + of_children[j];
  return bends;
}

}  // namespace bodyopt
