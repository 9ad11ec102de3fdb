// Which features a region listens to.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "runtime/basis/basis.h"
#include "trainer/dataset/character.h"
#include "trainer/train/regions.h"

namespace bodyopt {

// Static choice: rotations of the joints that move the region or lie near it, with their parents and children; strains
// of the fibres near it, nearest first; all controls. `character` in runtime order. Ascending indices into the features
// [joint features, strains, controls].
std::vector<std::uint32_t> nearby_features(const SoftRegion& region, const Character& character, const Basis& basis);

// Every joint feature and control, no strain.
std::vector<std::uint32_t> joint_features_only(const Basis& basis);

// Dynamic choice: adds the strains that best explain what a linear fit of `coefficients` (frames x K) to the chosen
// joint features and controls leaves, wherever their fibres lie. features: frames x F, standardised.
std::vector<std::uint32_t> add_explaining_strains(std::vector<std::uint32_t> chosen, const Basis& basis,
                                                  const Eigen::MatrixXd& features, const Eigen::MatrixXd& coefficients);

}  // namespace bodyopt
