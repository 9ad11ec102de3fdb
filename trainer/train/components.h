// Principal components of the displacements of a region.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "trainer/train/features.h"

namespace bodyopt {

// targets ~ coefficients * directions^T. Directions are orthonormal; nothing is subtracted, so that the rest pose (all
// zeros) has coefficients of zero.
struct Components {
  Eigen::MatrixXf directions;    // 3n x K
  Eigen::MatrixXd coefficients;  // frames x K, metres, largest variance first
};

// The `most` largest components of targets (frames x 3n, metres), without those whose coefficients have an RMS below
// `least`. Randomised subspace iteration (Halko et al. 2011), the same for the same seed.
Components principal_components(const FrameRows& targets, int most, double least, std::uint64_t seed);

}  // namespace bodyopt
