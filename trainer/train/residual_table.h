// The trained regions, packed for the runtime.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "runtime/basis/basis.h"
#include "trainer/train/regions.h"

namespace bodyopt {

// A region after training: delta ~ sum_k c_k direction_k over its vertices, c = weights [1, f, phi(f)].
struct RegionModel {
  std::vector<std::uint32_t> vertices;  // runtime order
  std::vector<std::uint32_t> features;  // into [joint features, strains, controls]
  Eigen::MatrixXd centres;              // M x F, standardised
  double inverse_width2 = 0;
  Eigen::MatrixXd weights;     // K x (1 + F + M), coefficients in metres
  Eigen::MatrixXf directions;  // 3n x K, at most 1
  Eigen::VectorXd largest;     // K, largest coefficient over the training frames, metres
};

// Fills everything but features and controls. At most `components` of each region are taken; blend entries that move
// their vertex by less than `least` metres in every training frame are left out. Throws Error(mismatch) when the
// coefficients do not fit their 16-bit index.
void pack_residual(const std::vector<RegionModel>& models, std::uint32_t vertex_count, int components, double least,
                   ResidualTable& residual);

}  // namespace bodyopt
