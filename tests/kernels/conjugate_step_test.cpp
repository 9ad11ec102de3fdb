#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace conjugate_step_test {

struct Case {
  Case(std::uint32_t seed, std::uint32_t count, float rho_, float pq_)
      : random(seed),
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

constexpr float kCurvatures[] = {1.7f, 0.0f, -1.0f, 1e-39f};

const bool added =
    add_kernel_cases({"conjugate_step",
                      "numbers",
                      "curvature",
                      {kSizes.begin(), kSizes.end()},
                      {0, 1, 2, 3},
                      [](KernelSet& kernels, const Trial& trial) {
                        const Case c(trial.seed(), trial.size, 1.3f, kCurvatures[trial.variant]);
                        const bool is_exact = trial.variant != 0;  // nothing is divided
                        return run_on<vulkan::ConjugateStep>(
                            kernels, {trial.size}, 1, {{c.next_solution, is_exact}, {c.next_residual, is_exact}}, c.rho,
                            c.pq, c.direction, c.product, c.solution, c.residual);
                      }});

TEST(ConjugateStepReference, EqualsTheTextbook) {
  const Case c(100, 100, 1.5f, 2.5f);
  for (std::size_t k = 0; k < 100; ++k) {
    EXPECT_NEAR(c.next_solution[k], c.solution[k] + 0.6 * static_cast<double>(c.direction[k]), 2e-7);
    EXPECT_NEAR(c.next_residual[k], c.residual[k] - 0.6 * static_cast<double>(c.product[k]), 2e-7);
  }
}

// Where nothing is left to solve, and where rounding left nothing to divide by, it stands still.
TEST(ConjugateStepReference, StandsStillWithoutCurvature) {
  for (const auto& [rho, pq] :
       {std::pair{0.0f, 0.0f}, {1.0f, 0.0f}, {1.0f, -1.0f}, {1e-40f, 1e-45f}, {1e30f, 2e-38f}}) {
    const Case c(100, 100, rho, pq);
    EXPECT_EQ(c.next_solution, c.solution) << rho << " / " << pq;
    EXPECT_EQ(c.next_residual, c.residual) << rho << " / " << pq;
  }
}

}  // namespace conjugate_step_test
}  // namespace bodyopt::testing
