// Features of the training frames, computed by the kernels that will run.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "assets/character.h"
#include "runtime/basis/basis.h"

namespace bodyopt {

using RawFeatures = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct FeatureSamples {
  RawFeatures raw;                   // N x F: joint features (radians), strains, controls, as they come
  std::vector<FeatureRange> ranges;  // F
  Eigen::MatrixXd values;            // N x F, clamped and standardised
  Eigen::RowVectorXd rest;           // F: those of the bind pose, controls zero
  std::uint32_t control_count = 0;   // the last features
};

// Rows of an earlier measurement with the same basis: which one is that of each pose, -1 for none.
struct KnownFeatures {
  RawFeatures raw;
  std::vector<int> rows;
};

// Ranges span the poses and the bind pose, widened by 1 %; a feature that does not vary gets inverse_scale 0. `basis`
// needs skeleton, ddm and strain. Throws Error(mismatch) when a pose does not fit the skeleton or the poses differ in
// their number of controls.
FeatureSamples measure_features(const Basis& basis, std::span<const Pose* const> poses,
                                const KnownFeatures& known = {});

// Those of `count` standardised features (N x F) from `begin` on that vary by more than noise, ascending.
std::vector<std::uint32_t> varying_features(const Eigen::MatrixXd& features, std::uint32_t begin, std::uint32_t count);

// Strains of one pose, S: of the basis' fibres, or of others on its skin, for which it needs skeleton and ddm alone.
std::vector<float> measure_strains(const Basis& basis, const Pose& pose);
std::vector<float> measure_strains(const Basis& basis, const StrainTable& fibres, const Pose& pose);

// Which joints' turns a character's skin is learned by: as joint_features_of() its skeleton, but that joints which all
// of the skin hangs under count as not turning: they bend none of it, and a body that leans must not look like one in a
// pose that training lacks. Empty where there are none but roots, as in Skeleton.
std::vector<JointFeatures> learned_features(const Character& character);

}  // namespace bodyopt
