// Linear blend skinning in double precision.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "assets/character.h"
#include "runtime/basis/skeleton.h"

namespace bodyopt {

using BlendMatrix = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;  // rest space to world

// One per joint. Throws Error(mismatch) when the pose has another number of joints than the skeleton.
std::vector<BlendMatrix> blend_matrices(const Skeleton& skeleton, const Pose& pose);

BlendMatrix blended(const std::vector<BlendMatrix>& skinning, const std::vector<JointWeight>& weights);

// Linear blend skinning, double precision, V x 3 welded; the baseline "lbs".
Positions skin_linear(const Character& character, const Pose& pose);

}  // namespace bodyopt
