#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/gpu_fixture.h"
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
    cpu::jiggle_end(step, of_frame(rotations, std::size_t{9} * count, frame), solution, local_displacement,
                    displacement, velocity);
  }

  Random random;
  std::uint32_t frame;
  JiggleStepPush step;
  std::vector<float> rotations, solution, local_displacement;
  std::vector<float> displacement, velocity;  // by the reference
};

class JiggleEnd : public GpuTest {};

TEST_F(JiggleEnd, EqualsTheReference) {
  const vulkan::JiggleEnd kernel(*device_);
  for (const std::uint32_t count : kSizes) {
    SCOPED_TRACE(std::to_string(count) + " nodes");
    const Case c(count);
    const auto rotations = vulkan::upload(*device_, c.rotations, "rotations"),
               z = vulkan::upload(*device_, c.solution, "solution"),
               u = vulkan::upload(*device_, c.local_displacement, "displacement");
    const std::size_t size = c.solution.size();
    const auto outputs = run_kernel(*device_, {size, size}, [&](auto& commands, const auto& out) {
      kernel.record(commands, {rotations, z, u, out[0], out[1]}, c.step);
    });
    expect_close(outputs[0], c.displacement, 0);  // sums and products in one order
    expect_close(outputs[1], c.velocity, 0);
  }
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
