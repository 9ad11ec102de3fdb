// Features of the training frames, computed by the kernels that will run.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "assets/characters/character.h"
#include "assets/characters/muscles.h"
#include "runtime/basis/basis.h"

namespace bodyopt::trainer {

// Rotations of the joints that training showed, alone and together with their neighbours'.

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

// Ranges span the poses and the bind pose, widened by 1 %; no deviation counts as less than 1e-3. `basis` needs
// skeleton, ddm and strain. Throws Error(mismatch) when a pose does not fit the skeleton or the poses differ in their
// number of controls.
FeatureSamples measure_features(const Basis& basis, std::span<const Pose* const> poses,
                                const KnownFeatures& known = {});

// Indices of features that vary by more than noise, ascending, of `count` standardised ones (N x F) from `begin` on.
std::vector<std::uint32_t> varying_features(const Eigen::MatrixXd& features, std::uint32_t begin, std::uint32_t count);

// Strains of one pose, S: of the basis' fibres, or of others on its skin, for which it needs skeleton and ddm alone.
std::vector<float> measure_strains(const Basis& basis, const Pose& pose);
std::vector<float> measure_strains(const Basis& basis, const StrainTable& fibres, const Pose& pose);

// The features of joints by which a character's skin is learned: joint_features_of() its skeleton with three changes.
// Joints which all of the skin hangs under count as not turning, since they bend none of it. A body that leans must not
// look like one in a pose that training lacks. A detached foot (detached_joints) is seen from the limb that it goes on
// from. Joints that poses slide by a hundredth of the character's longest extent have their places, too, after all
// rotations. A tenth of the extent counts as a radian. Places are left out where poses are no more than features: from
// so few more is learned by chance. Empty where all that changes nothing, as in Skeleton.
std::vector<JointFeatures> learned_features(const Character& character, std::span<const Pose* const> poses);

// All of a FadeTable but what it says of regions. Directions are principal axes of the features of a joint, its parent
// and its children (about rest). Along them the training frames turn by less than 0.03 radians, root mean square. A
// tolerance is how far 99 of 100 frames stand off what the other folds showed of a joint, in cross-validation. It is
// the largest of the training frames where that is more. `raw`: joint features first, N x F, radians; `folds`: as
// RegressionData has them.
FadeTable joint_manifold(const Skeleton& skeleton, const RawFeatures& raw, const std::vector<int>& folds);

// Mean square of a joint's features over the training frames, radians squared. Per joint, as feature_joints().
std::vector<double> joint_turns(const RawFeatures& raw, std::size_t joint_count);

// Each muscle has fibre_count fibres, side by side on the half of its belly that faces the skin. Fibres that collapse
// to a point there are left out. Rest lengths are measured by the runtime's kernels. `basis` needs skeleton, mesh and
// ddm. Without muscles, or without triangles, an empty table.
StrainTable make_strain_table(const Basis& basis, const std::vector<Muscle>& muscles);

// The table of some fibres, by ascending index.
StrainTable keep_fibres(const StrainTable& strain, const std::vector<std::uint32_t>& kept);

// Muscle of each fibre of the table, by the fibre's name.
std::vector<std::size_t> fibre_muscles(const StrainTable& strain, const std::vector<Muscle>& muscles);

}  // namespace bodyopt::trainer
