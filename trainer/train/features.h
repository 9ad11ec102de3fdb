// Features of the training frames, computed by the kernels that will run.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

struct FeatureSamples {
  std::vector<FeatureRange> ranges;  // F: joint features, strains, controls
  Eigen::MatrixXd values;            // N x F, clamped and standardised
  Eigen::RowVectorXd rest;           // F: those of the bind pose, controls zero
};

// Ranges span the poses and the bind pose, widened by 1 %; a feature that does not vary gets inverse_scale 0. `basis`
// needs skeleton, ddm and strain. Throws Error(mismatch) when a pose does not fit the skeleton or the poses differ in
// their number of controls.
FeatureSamples measure_features(const Basis& basis, std::span<const Pose* const> poses);

// Strains of one pose, S.
std::vector<float> measure_strains(const Basis& basis, const Pose& pose);

}  // namespace bodyopt
