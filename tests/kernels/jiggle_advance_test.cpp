#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_jiggle.h"

namespace bodyopt::testing {
namespace jiggle_advance_test {

constexpr std::uint32_t kBatch = 3;

struct Case {
  explicit Case(std::uint32_t count)
      : random(count),
        frame(random.below(kBatch)),
        step(random_step(random, count, frame, 1, 0)),
        rotations(random_rotations(random, kBatch * count, 3)),
        solution(random.floats(std::size_t{3} * count, -1, 1)),
        displacement(random.floats(std::size_t{3} * count, -1, 1)),
        velocity(random.floats(std::size_t{3} * count, -1, 1)),
        next_displacement(solution.size()),
        next_velocity(solution.size()),
        right_side(solution.size()) {
    jiggle.nodes = random_jiggle_nodes(random, count, 1, 0);
    cpu::jiggle_advance(jiggle, step, of_frame(rotations, 9 * jiggle.nodes.size(), frame), solution, displacement,
                        velocity, next_displacement, next_velocity, right_side);
  }

  Random random;
  std::uint32_t frame;
  JiggleStepPush step;
  JiggleTable jiggle;
  std::vector<float> rotations, solution, displacement, velocity;
  std::vector<float> next_displacement, next_velocity, right_side;  // by the reference
};

const bool added = add_kernel_cases("jiggle_advance", "nodes", [](KernelSet& kernels, const Trial& trial) {
  const Case c(trial.size);
  // Sums and products in one order.
  return run_on<vulkan::JiggleAdvance>(kernels, c.step, 1, {{c.next_displacement}, {c.next_velocity}, {c.right_side}},
                                       c.jiggle.nodes, c.rotations, c.solution, c.displacement, c.velocity);
});

TEST(JiggleAdvanceReference, EqualsTheTextbook) {
  const Case c(200);
  const JiggleStepPush& s = c.step;
  for (std::size_t n = 0; n < 200; ++n) {
    const JiggleNode& node = c.jiggle.nodes[n];
    const Eigen::Matrix3d r = matrix_of(of_frame(c.rotations, 9 * 200, c.frame), n);
    const Eigen::Vector3d z = point_of(c.solution, n), u = point_of(c.displacement, n), v = point_of(c.velocity, n);
    const Eigen::Vector3d g(s.gravity_x, s.gravity_y, s.gravity_z);
    const Eigen::Vector3d next_u = s.u_from_u * u + s.u_from_z * z;
    const Eigen::Vector3d next_v = s.v_from_u * u + s.v_from_z * z + s.v_from_v * v;
    const Eigen::Vector3d right = s.velocity_weight * node.mass * (next_v + s.stage * r.transpose() * g) +
                                  s.displacement_weight * node.inertia * next_u;
    ASSERT_LT((point_of(c.next_displacement, n) - next_u).norm(), 1e-6);
    ASSERT_LT((point_of(c.next_velocity, n) - next_v).norm(), 2e-6);
    ASSERT_LT((point_of(c.right_side, n) - right).norm(), 1e-5);
  }
}

}  // namespace jiggle_advance_test
}  // namespace bodyopt::testing
