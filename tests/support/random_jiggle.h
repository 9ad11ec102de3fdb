// Seeded random inputs of the jiggle's kernels.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/basis/dynamics.h"
#include "tests/support/random_tets.h"

namespace bodyopt::testing {

// count x 9, row-major: turned by at most `angle` radians.
std::vector<float> random_rotations(Random& random, std::uint32_t count, double angle);

// Numbers of the order of 1. Two nodes of three are in a muscle; two muscles of three have a control, some of them one
// that the basis does not have.
std::vector<JiggleNode> random_jiggle_nodes(Random& random, std::uint32_t count, std::uint32_t fibres,
                                            std::uint32_t controls);

// Numbers of the order of 1.
JiggleStepPush random_step(Random& random, std::uint32_t nodes, std::uint32_t frame, std::uint32_t fibres,
                           std::uint32_t controls);

// Frame number `frame` of a batch whose frames have `count` values.
inline std::span<const float> of_frame(const std::vector<float>& batch, std::size_t count, std::uint32_t frame) {
  return std::span(batch).subspan(count * frame, count);
}

// One after the other, as the parts of a motion are on a device.
std::vector<float> joined(const std::vector<std::vector<float>>& parts);

// Matrix n of N x 9.
Eigen::Matrix3d matrix_of(std::span<const float> values, std::size_t n);

}  // namespace bodyopt::testing
