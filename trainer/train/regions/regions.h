// Soft regions in which the skin learns together, and what each of them listens to.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "assets/characters/character.h"
#include "assets/characters/muscles.h"
#include "runtime/basis/basis.h"
#include "trainer/train/regression/components.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::trainer {

// Features that belong together: the rotation of a joint, or the fibres of a muscle.
struct FeatureGroup {
  std::vector<std::uint32_t> features;  // those that vary
  Positions points;                     // where it sits, rest space, metres; none: everywhere
  Eigen::VectorXd influence;            // V: its share in how the skin moves, 0..1
  std::vector<std::size_t> spans;       // of a muscle: the groups of the joints it acts across
};

// Joints (in the order of the joint features), then muscles, then controls (each control one group that acts
// everywhere). `features`: N x F, standardised, `displacements` those of the same frames. A joint's influence is its
// smoothed skin weight (static). A muscle's is the part of the un-posed motion that its strains explain beyond a linear
// fit of the joints (dynamic).
std::vector<FeatureGroup> make_feature_groups(const Basis& basis, const std::vector<VertexMoments>& moments,
                                              const std::vector<Muscle>& muscles, const Eigen::MatrixXd& features,
                                              const Displacements& displacements);

// Joints a muscle acts across: those between its points, below their common ancestor.
std::vector<std::uint32_t> spanned_joints(const Skeleton& skeleton, const Muscle& muscle);

// The `painted` regions (whose weights sum to 1 at most), and regions of what they leave of the skin. The vertices of
// these lie together and have like influences: k-means from farthest-point seeds, then smoothed. All weights together
// are a partition of unity. Regions without a name get that of the joint they lie at, and a number where it is taken.
std::vector<RegionWeights> make_regions(const Character& character, const std::vector<FeatureGroup>& groups,
                                        const std::vector<RegionWeights>& painted);

// Names of the joints with a share of 5 % and more in the skin of a region, the largest first; never none.
std::vector<std::string> joints_of(const Character& character, const RegionWeights& region);

// Features of the groups that reach a region: within `radius` metres of it or of notable influence there, and the
// joints spanned by its muscles. Never empty where any feature varies.
std::vector<std::uint32_t> region_features(const Character& character, const RegionWeights& region,
                                           const std::vector<FeatureGroup>& groups, double radius);

}  // namespace bodyopt::trainer
