// Seeded random inputs of the jiggle's kernels.
#pragma once

#include "runtime/basis/dynamics.h"
#include "tests/support/random_tets.h"

namespace bodyopt::testing {

// count x 9, row-major: turned by at most `angle` radians.
inline std::vector<float> random_rotations(Random& random, std::uint32_t count, double angle) {
  const std::vector<float> rigid = random_skinning(random, count, 1, angle);
  std::vector<float> rotations;
  for (std::size_t k = 0; k < rigid.size(); ++k) {
    if (k % 4 < 3) rotations.push_back(rigid[k]);
  }
  return rotations;
}

// Numbers of the order of 1. Two nodes of three are in a muscle; two muscles of three have a control, some of them one
// that the basis does not have.
inline std::vector<JiggleNode> random_jiggle_nodes(Random& random, std::uint32_t count, std::uint32_t fibres,
                                                   std::uint32_t controls) {
  std::vector<JiggleNode> nodes;
  for (std::uint32_t n = 0; n < count; ++n) {
    JiggleNode node{};
    node.mass = static_cast<float>(random.uniform(0.5, 2));
    node.inertia = static_cast<float>(random.uniform(0.5, 2));
    node.control = kNoControl;
    if (n % 3 > 0) {
      node.first_fibre = random.below(fibres);
      node.fibre_count = 1 + random.below(fibres - node.first_fibre);
      node.stiffening = static_cast<float>(random.uniform(0, 1000));
      if (random.below(3) > 0) node.control = random.below(controls + 1);
    }
    nodes.push_back(node);
  }
  return nodes;
}

// Numbers of the order of 1.
inline JiggleStepPush random_step(Random& random, std::uint32_t nodes, std::uint32_t frame, std::uint32_t fibres,
                                  std::uint32_t controls) {
  const auto number = [&] { return static_cast<float>(random.uniform(-2, 2)); };
  JiggleStepPush step{};
  step.node_count = nodes;
  step.frame = frame;
  step.fibre_count = fibres;
  step.control_count = controls;
  step.duration = 1.0f / 24;
  step.stage = 0.1f;
  for (float* value :
       {&step.gravity_x, &step.gravity_y, &step.gravity_z, &step.velocity_weight, &step.displacement_weight,
        &step.u_from_u, &step.u_from_z, &step.v_from_u, &step.v_from_z, &step.v_from_v}) {
    *value = number();
  }
  return step;
}

// Frame number `frame` of a batch whose frames have `count` values.
inline std::span<const float> of_frame(const std::vector<float>& batch, std::size_t count, std::uint32_t frame) {
  return std::span(batch).subspan(count * frame, count);
}

// One after the other, as the parts of a motion are on a device.
inline std::vector<float> joined(const std::vector<std::vector<float>>& parts) {
  std::vector<float> all;
  for (const std::vector<float>& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

// Matrix n of N x 9.
inline Eigen::Matrix3d matrix_of(std::span<const float> values, std::size_t n) {
  return Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(values.data() + 9 * n).cast<double>();
}

}  // namespace bodyopt::testing
