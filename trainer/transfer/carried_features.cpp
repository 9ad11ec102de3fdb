#include "trainer/transfer/carried_features.h"

#include <algorithm>

#include "runtime/host/rig.h"

namespace bodyopt {
namespace {

// The nearest joint at or above `joint` that both have, of the target; -1 for none.
int target_at_or_above(const Skeleton& source, const SkeletonMatch& match, int joint) {
  while (joint >= 0 && match.target_joint[static_cast<std::size_t>(joint)] < 0) {
    joint = source.joints[static_cast<std::size_t>(joint)].parent;
  }
  return joint < 0 ? -1 : match.target_joint[static_cast<std::size_t>(joint)];
}

bool is_below(const Skeleton& skeleton, int joint, int above) {
  while (joint >= 0 && joint != above) joint = skeleton.joints[static_cast<std::size_t>(joint)].parent;
  return joint >= 0;
}

JointFeatures carried(const JointFeatures& of, const Skeleton& source, const Skeleton& target,
                      const SkeletonMatch& match) {
  const int own = match.target_joint[of.joint];
  const int top = target_at_or_above(source, match, static_cast<int>(of.above));
  if (own < 0 || top < 0 || of.joint == of.above || !is_below(target, own, top)) {  // it does not turn
    const int at = target_at_or_above(source, match, static_cast<int>(of.joint));
    return {static_cast<std::uint32_t>(std::max(at, 0)), static_cast<std::uint32_t>(std::max(at, 0))};
  }
  const auto below = static_cast<std::uint32_t>(own), above = static_cast<std::uint32_t>(top);
  return {below, above, of.above_turn * match.alignment[above], of.own_turn * match.alignment[below]};
}

}  // namespace

std::vector<JointFeatures> carried_features(const Skeleton& source, const Skeleton& target,
                                            const SkeletonMatch& match) {
  std::vector<JointFeatures> features;
  for (const JointFeatures& of : joint_features_of(source)) {
    features.push_back(carried(of, source, target, match));
  }
  return features == joint_features_of(target) ? std::vector<JointFeatures>{} : features;
}

Pose pose_at_target_rest(const SkeletonMatch& match, const Skeleton& source) {
  Pose pose = bind_pose(source);
  const std::vector<Quat> bind = bind_rotations(source);
  std::vector<Quat> away(source.size());
  for (std::size_t j = 0; j < source.size(); ++j) {
    const int parent = source.joints[j].parent, other = match.target_joint[j];
    const Quat above = parent < 0 ? Quat{0, 0, 0, 1} : away[static_cast<std::size_t>(parent)];
    away[j] = other >= 0 ? conjugate(match.alignment[static_cast<std::size_t>(other)]) : above;
    const Quat world_above = parent < 0 ? above : above * bind[static_cast<std::size_t>(parent)];
    if (away[j] != above || parent < 0)
      pose.joints[j].rotation = normalized(conjugate(world_above) * away[j] * bind[j]);
  }
  return pose;
}

}  // namespace bodyopt
