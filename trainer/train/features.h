// What the residual sees of a frame, computed with the kernels of the run time.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

using FrameRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;  // one row per frame

// Joint features, strains and controls of each pose, as they are. -> frames x F. Throws Error(mismatch) for a pose that
// does not fit the skeleton or has another number of controls than the basis.
FrameRows raw_features(const Basis& basis, const std::vector<Pose>& poses);

// The range of each column, widened by 1 % on both sides, and its mean and standard deviation. A feature that hardly
// moves is not blown up: the deviation counts as 1e-3 at least.
std::vector<FeatureRange> feature_ranges(const FrameRows& raw);

// Clamped and standardised with basis.residual.features. -> frames x F
FrameRows standardised_features(const Basis& basis, const FrameRows& raw);

}  // namespace bodyopt
