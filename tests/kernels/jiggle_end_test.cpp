#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_jiggle.h"

namespace bodyopt::testing {
namespace jiggle_end_test {

constexpr std::uint32_t kBatch = 3;

struct Case {
  explicit Case(std::uint32_t count)
      : random(count),
        frame(random.below(kBatch)),
        step(random_step(random, count, frame, 1, 0)),
        rotations(random_rotations(random, kBatch * count, 3)),
        solution(random.floats(std::size_t{3} * count, -1, 1)),
        local_displacement(random.floats(std::size_t{3} * count, -1, 1)),
        displacement(solution.size()),
        velocity(solution.size()) {
    run();
  }

  void run() {
    cpu::jiggle_end(step, of_frame(rotations, std::size_t{9} * step.node_count, frame), solution, local_displacement,
                    displacement, velocity);
  }

  // Sums and products in one order.
  KernelRun on(KernelSet& kernels) const {
    return run_on<vulkan::JiggleEnd>(kernels, step, 1, {{joined({displacement, velocity})}}, rotations, solution,
                                     local_displacement);
  }

  Random random;
  std::uint32_t frame;
  JiggleStepPush step;
  std::vector<float> rotations, solution, local_displacement;
  std::vector<float> displacement, velocity;  // by the reference
};

class JiggleEnd : public GpuTest {};

const bool added = add_kernel_cases(
    "jiggle_end", "nodes", [](KernelSet& kernels, const Trial& trial) { return Case(trial.size).on(kernels); });

TEST_F(JiggleEnd, WhatIsNextToNothingIsZero) {
  Case c(100);
  for (std::vector<float>* values : {&c.solution, &c.local_displacement}) {
    for (std::size_t k = 0; k < 150; ++k) (*values)[k] *= kStill / 8;
  }
  c.run();
  for (const std::vector<float>* values : {&c.displacement, &c.velocity}) {
    EXPECT_TRUE(std::all_of(values->begin(), values->begin() + 150, [](float value) { return value == 0; }));
    EXPECT_TRUE(
        std::none_of(values->begin() + 150, values->end(), [](float value) { return std::abs(value) < kStill; }));
  }
  KernelSet kernels(*device_);
  expect_reference(*device_, "jiggle_end", c.on(kernels));
}

TEST(JiggleEndReference, EqualsTheTextbook) {
  const Case c(200);
  for (std::size_t n = 0; n < 200; ++n) {
    const Eigen::Matrix3d r = matrix_of(of_frame(c.rotations, 9 * 200, c.frame), n);
    const Eigen::Vector3d z = point_of(c.solution, n), u = point_of(c.local_displacement, n);
    ASSERT_LT((point_of(c.displacement, n) - r * (c.step.u_from_u * u + c.step.u_from_z * z)).norm(), 2e-6);
    ASSERT_LT((point_of(c.velocity, n) - r * (c.step.v_from_u * u + c.step.v_from_z * z)).norm(), 2e-6);
  }
}

}  // namespace jiggle_end_test
}  // namespace bodyopt::testing
