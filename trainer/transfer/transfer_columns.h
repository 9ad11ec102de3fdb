// The features and the columns of a trained residual, carried to another skeleton and skin.
#pragma once

#include <vector>

#include "runtime/basis/basis.h"
#include "trainer/transfer/match_skeletons.h"
#include "trainer/transfer/skin_transfer.h"

namespace bodyopt::trainer {

// Replaces the blend of `residual`, which is that of the source, by the target's (`vertices` of them): every column is
// carried over, then packed. Small entries of blocks are left out, and entries that eight bits round much are packed
// twice. Either costs at most `tolerance` metres, root mean square over the skin. Shows progress.
void transfer_columns(const SkinTransfer& transfer, std::uint32_t source_vertices, std::uint32_t vertices,
                      double tolerance, ResidualTable& residual);

// The source's joint features, in their order, on the target's joints; empty where the target's own are the same. With
// the alignments C, R_k = C_a R'_k C_k^T. Joint a is the one above k that both characters have, whatever joints the
// target has between the two. Joints that the target does not have do not turn.
std::vector<JointFeatures> carried_features(const Skeleton& source, const Skeleton& target, const SkeletonMatch& match);

// The pose of the source in which it stands as the target rests.
Pose pose_at_target_rest(const SkeletonMatch& match, const Skeleton& source);

}  // namespace bodyopt::trainer
