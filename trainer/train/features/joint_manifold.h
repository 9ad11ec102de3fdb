// Which rotations of the joints training showed, alone and together with their neighbours'.
#pragma once

#include <vector>

#include "runtime/basis/basis.h"
#include "trainer/train/features/features.h"

namespace bodyopt {

// All of a FadeTable but what it tells of regions. Directions are, of those principal axes of the features of a joint,
// its parent and its children (about rest) along which the training frames turn by less than 0.03 radians, root mean
// square. A tolerance is what cross-validation finds of a joint: how far 99 of 100 frames stand off
// what the other folds showed, or the largest of the training frames where that is more. `raw`: joint features first,
// N x F, radians; `folds`: as RegressionData has them.
FadeTable joint_manifold(const Skeleton& skeleton, const RawFeatures& raw, const std::vector<int>& folds);

// Mean square of a joint's features over the training frames, radians squared: how much it turns. Per joint, as
// feature_joints().
std::vector<double> joint_turns(const RawFeatures& raw, std::size_t joint_count);

}  // namespace bodyopt
