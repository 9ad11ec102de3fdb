// Principal components of un-posed displacements in one region.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "geometry/region_weights.h"

namespace bodyopt::trainer {

// Un-posed displacements of the training frames: N x 3V (x, y, z of vertex 0, then of vertex 1), metres.
using Displacements = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct Components {
  Eigen::MatrixXd coefficients;  // N x K, metres
  Eigen::MatrixXd basis;         // K x 3 region vertices: what one metre of a coefficient adds, region weights included
  Eigen::VectorXd energy;        // N, square metres: the sum of all squared displacements, weighted by the region
  Eigen::VectorXd truncated;     // N: of that, what the components leave
};

// The leading components of the displacements, weighted by the region, not centred (no displacement at rest means no
// coefficient). Fewer than `count` where the data has no more rank. Deterministic for a seed.
Components principal_components(const Displacements& displacements, const RegionWeights& region, int count,
                                std::uint64_t seed);

// K: the length of every component, each vertex divided by the root of its weight. In metres of the region's weighted
// displacements a coefficient counts as many times.
Eigen::VectorXd component_lengths(const Components& components, const RegionWeights& region);

// Coefficients of other displacements on the components' basis, whose columns may have been scaled, with the energies
// that belong to them.
Components on_basis_of(const Components& components, const Displacements& displacements, const RegionWeights& region);

}  // namespace bodyopt::trainer
