#include "tests/support/random_jiggle.h"

namespace bodyopt::testing {

std::vector<float> random_rotations(Random& random, std::uint32_t count, double angle) {
  const std::vector<float> rigid = random_skinning(random, count, 1, angle);
  std::vector<float> rotations;
  for (std::size_t k = 0; k < rigid.size(); ++k) {
    if (k % 4 < 3) rotations.push_back(rigid[k]);
  }
  return rotations;
}

std::vector<JiggleNode> random_jiggle_nodes(Random& random, std::uint32_t count, std::uint32_t fibres,
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

JiggleStepPush random_step(Random& random, std::uint32_t nodes, std::uint32_t frame, std::uint32_t fibres,
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

std::vector<float> joined(const std::vector<std::vector<float>>& parts) {
  std::vector<float> all;
  for (const std::vector<float>& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

Eigen::Matrix3d matrix_of(std::span<const float> values, std::size_t n) {
  return Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(values.data() + 9 * n).cast<double>();
}

}  // namespace bodyopt::testing
