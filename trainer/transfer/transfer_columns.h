// The features and the columns of a trained residual, carried to another skeleton and skin.
#pragma once

#include <vector>

#include "runtime/basis/basis.h"
#include "trainer/transfer/match_skeletons.h"
#include "trainer/transfer/skin_transfer.h"

namespace bodyopt {

// Replaces the blend of `residual`, which is that of the source, by the target's (`vertices` of them): every column is
// carried over, then packed. What a block has little of is left out, and what eight bits leave much of is packed twice,
// so that either costs at most `tolerance` metres, root mean square over the skin. Shows progress.
void transfer_columns(const SkinTransfer& transfer, std::uint32_t source_vertices, std::uint32_t vertices,
                      double tolerance, ResidualTable& residual);

// The joint features, told by the joints of the target: of every joint of the source that has features, in their order;
// empty where the target's own are the same. With the alignments C of a joint k and of the joint a above it that both
// characters have, R_k = C_a R'_k C_k^T, whatever joints the target has between the two. Joints that the target does
// not have do not turn.
std::vector<JointFeatures> carried_features(const Skeleton& source, const Skeleton& target, const SkeletonMatch& match);

// The pose of the source in which it stands as the target rests.
Pose pose_at_target_rest(const SkeletonMatch& match, const Skeleton& source);

}  // namespace bodyopt
