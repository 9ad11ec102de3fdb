#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace conjugate_step_test {

struct Case {
  Case(std::uint32_t count, float rho_, float pq_)
      : random(count),
        rho{rho_},
        pq{pq_},
        direction(random.floats(count, -1, 1)),
        product(random.floats(count, -1, 1)),
        solution(random.floats(count, -1, 1)),
        residual(random.floats(count, -1, 1)),
        next_solution(count),
        next_residual(count) {
    cpu::conjugate_step(rho, pq, direction, product, solution, residual, next_solution, next_residual);
  }

  Random random;
  std::vector<float> rho, pq, direction, product, solution, residual;
  std::vector<float> next_solution, next_residual;  // by the reference
};

class ConjugateStep : public GpuTest {};

TEST_F(ConjugateStep, EqualsTheReference) {
  const vulkan::ConjugateStep kernel(*device_);
  for (const std::uint32_t count : kSizes) {
    for (const float pq : {1.7f, 0.0f, -1.0f, 1e-39f}) {
      SCOPED_TRACE(std::to_string(count) + " numbers, pq " + std::to_string(pq));
      const Case c(count, 1.3f, pq);
      const auto rho = vulkan::upload(*device_, c.rho, "rho"), pq_buffer = vulkan::upload(*device_, c.pq, "pq"),
                 direction = vulkan::upload(*device_, c.direction, "direction"),
                 product = vulkan::upload(*device_, c.product, "product"),
                 solution = vulkan::upload(*device_, c.solution, "solution"),
                 residual = vulkan::upload(*device_, c.residual, "residual");
      const auto outputs = run_kernel(*device_, {count, count}, [&](auto& commands, const auto& out) {
        kernel.record(commands, {rho, pq_buffer, direction, product, solution, residual, out[0], out[1]}, {count});
      });
      expect_close(outputs[0], c.next_solution, pq > 1 ? 5e-7 : 0);  // a division of a few ulp
      expect_close(outputs[1], c.next_residual, pq > 1 ? 5e-7 : 0);
    }
  }
}

TEST(ConjugateStepReference, EqualsTheTextbook) {
  const Case c(100, 1.5f, 2.5f);
  for (std::size_t k = 0; k < 100; ++k) {
    EXPECT_NEAR(c.next_solution[k], c.solution[k] + 0.6 * static_cast<double>(c.direction[k]), 2e-7);
    EXPECT_NEAR(c.next_residual[k], c.residual[k] - 0.6 * static_cast<double>(c.product[k]), 2e-7);
  }
}

// Where nothing is left to solve, and where rounding left nothing to divide by, it stands still.
TEST(ConjugateStepReference, StandsStillWithoutCurvature) {
  for (const auto& [rho, pq] :
       {std::pair{0.0f, 0.0f}, {1.0f, 0.0f}, {1.0f, -1.0f}, {1e-40f, 1e-45f}, {1e30f, 2e-38f}}) {
    const Case c(100, rho, pq);
    EXPECT_EQ(c.next_solution, c.solution) << rho << " / " << pq;
    EXPECT_EQ(c.next_residual, c.residual) << rho << " / " << pq;
  }
}

}  // namespace conjugate_step_test
}  // namespace bodyopt::testing
