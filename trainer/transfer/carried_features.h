// The source's joint features, told by the joints of the target.
#pragma once

#include <vector>

#include "runtime/basis/basis.h"
#include "trainer/transfer/match_skeletons.h"

namespace bodyopt {

// Of every joint of the source that has features, in their order; empty where the target's own are the same. With the
// alignments C of a joint k and of the joint a above it that both characters have, R_k = C_a R'_k C_k^T, whatever
// joints the target has between the two. Joints that the target does not have do not turn.
std::vector<JointFeatures> carried_features(const Skeleton& source, const Skeleton& target, const SkeletonMatch& match);

// The pose of the source in which it stands as the target rests.
Pose pose_at_target_rest(const SkeletonMatch& match, const Skeleton& source);

}  // namespace bodyopt
