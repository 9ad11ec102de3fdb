// Matches the joints of two characters, and poses the target as the source rests.
#pragma once

#include <string>
#include <vector>

#include "base/json_file.h"
#include "runtime/basis/basis.h"

namespace bodyopt::trainer {

struct SkeletonMatch {
  std::vector<int> source_joint;  // per joint of the target: its joint of the source, or -1
  std::vector<int> target_joint;  // the other way round
  // Per joint of the target, world: from its bind pose to the source's. A joint without a match takes that above it.
  std::vector<Quat> alignment;
  Pose common;      // the target, posed as the source rests; where the source stands
  double size = 1;  // of the target over the source: the lengths between matched joints, in total
  // Standard deviation of the logarithm of the ratios of these lengths, each weighed by its share of either body: 0.1
  // is about 10 per cent.
  double other_proportions = 0;
  std::vector<std::string> notes;

  // False where every joint rests alike, but for what builds differ by: all alignments are then the identity.
  bool is_aligned() const;
};

// Joints are matched as match_joints() says, by name, convention and `joint_map` (a file, or empty). The target is
// turned as a whole where it stands 35 degrees or more from the source, or differs in place and size alone. A joint's
// bones are laid along those of the source, with least twist, where they lie 35 degrees or more from them. Less is a
// difference of build, as are those of a trunk, by its joints' names. Throws Error(mismatch) where fewer than two
// joints match or none are apart, where the target is the source's mirror image, and as match_joints().
SkeletonMatch match_skeletons(const Skeleton& source, const Skeleton& target, const std::string& joint_map);

// The nearest joint at or above one (-1: of none) that has a match; -1 for none. `match`: per joint of the skeleton.
int matched_at_or_above(const Skeleton& skeleton, const std::vector<int>& match, int joint);

// J x 3, world: of a skeleton's joints in a pose.
Positions joint_places(const Skeleton& skeleton, const Pose& pose);

// The matched joints, for the metadata of what is carried (assets/clips/matched_joints.h).
Json to_json(const SkeletonMatch& match, const Skeleton& source, const Skeleton& target);

// The match with its source that the metadata of the target, a carried basis, names. Where it names other joints or
// none, this is match_skeletons() without a joint map, and throws as that.
SkeletonMatch match_as_carried(const Skeleton& source, const Skeleton& target, const Metadata& target_metadata);

// The target's pose that moves each joint as the source's pose moves its match away from rest. Translations and scales
// are those of the source, changed as much, in the target's size.
Pose transferred_pose(const SkeletonMatch& match, const Skeleton& source, const Skeleton& target, const Pose& pose);

}  // namespace bodyopt::trainer
