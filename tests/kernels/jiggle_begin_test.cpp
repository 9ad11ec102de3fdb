#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_jiggle.h"

namespace bodyopt::testing {
namespace jiggle_begin_test {

constexpr std::uint32_t kFibres = 13, kControls = 4, kBatch = 3;

struct Case {
  explicit Case(std::uint32_t count)
      : random(count),
        frame(random.below(kBatch)),
        step(random_step(random, count, frame, kFibres, kControls)),
        rotations(random_rotations(random, kBatch * count, 3)),
        strains(random.floats(kBatch * kFibres, -0.3, 0.1)),
        controls(random.floats(kBatch * kControls, -0.5, 1.5)),
        displacement(random.floats(std::size_t{3} * count, -1, 1)),
        velocity(random.floats(std::size_t{3} * count, -1, 1)),
        local_displacement(displacement.size()),
        local_velocity(displacement.size()),
        right_side(displacement.size()) {
    jiggle.nodes = random_jiggle_nodes(random, count, kFibres, kControls);
    run();
  }

  void run() {
    cpu::jiggle_begin(jiggle, step, of_frame(rotations, 9 * jiggle.nodes.size(), frame),
                      of_frame(strains, kFibres, frame), of_frame(controls, kControls, frame), displacement, velocity,
                      local_displacement, local_velocity, right_side);
  }

  Random random;
  std::uint32_t frame;
  JiggleStepPush step;
  JiggleTable jiggle;
  std::vector<float> rotations, strains, controls, displacement, velocity;
  std::vector<float> local_displacement, local_velocity, right_side;  // by the reference
};

const bool added = add_kernel_cases("jiggle_begin", "nodes", [](KernelSet& kernels, const Trial& trial) {
  const Case c(trial.size);
  return run_on<vulkan::JiggleBegin>(kernels, c.step, 1, {{c.local_displacement}, {c.local_velocity}, {c.right_side}},
                                     c.jiggle.nodes, c.rotations, c.strains, c.controls,
                                     joined({c.displacement, c.velocity}));
});

TEST(JiggleBeginReference, EqualsTheTextbook) {
  const Case c(200);
  std::size_t active = 0, passive = 0;
  for (std::size_t n = 0; n < 200; ++n) {
    const JiggleNode& node = c.jiggle.nodes[n];
    double activation = 0;
    for (std::uint32_t f = 0; f < node.fibre_count; ++f) {
      activation -= c.strains[kFibres * c.frame + node.first_fibre + f] / (0.2 * node.fibre_count);
    }
    activation = std::clamp(activation, 0.0, 1.0);
    if (node.control < kControls) {
      const double control = std::clamp<double>(c.controls[kControls * c.frame + node.control], 0, 1);
      activation = 1 - (1 - activation) * (1 - control);
    }
    ++(activation > 0 ? active : passive);
    const Eigen::Matrix3d r = matrix_of(of_frame(c.rotations, 9 * 200, c.frame), n);
    const double h = c.step.duration, w2 = activation * node.stiffening;
    const Eigen::Vector3d g(c.step.gravity_x, c.step.gravity_y, c.step.gravity_z);
    const Eigen::Vector3d u = r.transpose() * point_of(c.displacement, n);
    const Eigen::Vector3d v = (r.transpose() * point_of(c.velocity, n) - h * w2 * u) / (1 + h * h * w2);
    const Eigen::Vector3d right = c.step.velocity_weight * node.mass * (v + c.step.stage * r.transpose() * g) +
                                  c.step.displacement_weight * node.inertia * u;
    ASSERT_LT((point_of(c.local_displacement, n) - u).norm(), 1e-6);
    ASSERT_LT((point_of(c.local_velocity, n) - v).norm(), 1e-5) << "activation " << activation;
    ASSERT_LT((point_of(c.right_side, n) - right).norm(), 5e-5);
  }
  EXPECT_GT(active, 20u);
  EXPECT_GT(passive, 20u);
}

// Velocity after the kick of a muscle whose only fibre has this strain, its node 1 m off.
float pulled(float strain) {
  JiggleTable jiggle;
  jiggle.nodes = {{1, 1, 0, 1, kNoControl, 1e4f}};
  JiggleStepPush step{};
  step.duration = 1.0f / 24;
  const std::vector<float> identity = {1, 0, 0, 0, 1, 0, 0, 0, 1}, strains = {strain}, u = {1, 0, 0}, v(3);
  std::vector<float> local_u(3), local_v(3), right_side(3);
  cpu::jiggle_begin(jiggle, step, identity, strains, {}, u, v, local_u, local_v, right_side);
  return local_v[0];
}

// Contracted muscles pull towards the quasi-static shape, up to full activation; in a step never beyond it, however
// stiff they are.
TEST(JiggleBeginReference, ContractedMusclesPullBack) {
  EXPECT_EQ(pulled(0.1f), 0);
  EXPECT_EQ(pulled(0), 0);
  EXPECT_LT(pulled(-0.05f), 0);
  EXPECT_LT(pulled(-0.1f), pulled(-0.05f));
  EXPECT_LT(pulled(-0.2f), pulled(-0.1f));
  EXPECT_EQ(pulled(-0.9f), pulled(-0.2f));
  EXPECT_GT(1 + pulled(-0.9f) / 24, 0);
}

TEST(JiggleBeginReference, RestStaysExactlyAtRest) {
  Case c(200);
  std::fill(c.displacement.begin(), c.displacement.end(), 0.0f);
  std::fill(c.velocity.begin(), c.velocity.end(), 0.0f);
  c.step.gravity_x = c.step.gravity_y = c.step.gravity_z = 0;
  c.run();
  const std::vector<float> zero(600, 0.0f);
  EXPECT_EQ(c.local_displacement, zero);
  EXPECT_EQ(c.local_velocity, zero);
  EXPECT_EQ(c.right_side, zero);
}

}  // namespace jiggle_begin_test
}  // namespace bodyopt::testing
