#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace conjugate_direction_test {

struct Case {
  Case(std::uint32_t seed, std::uint32_t count, float rho_, float next_rho_)
      : random(seed),
        rho{rho_},
        next_rho{next_rho_},
        y(random.floats(count, -1, 1)),
        direction(random.floats(count, -1, 1)),
        next_direction(count) {
    cpu::conjugate_direction(rho, next_rho, y, direction, next_direction);
  }

  Random random;
  std::vector<float> rho, next_rho, y, direction;
  std::vector<float> next_direction;  // by the reference
};

constexpr float kRhos[] = {1.7f, 0.0f};

const bool added = add_kernel_cases({"conjugate_direction",
                                     "numbers",
                                     "rho",
                                     {kSizes.begin(), kSizes.end()},
                                     {0, 1},
                                     [](KernelSet& kernels, const Trial& trial) {
                                       const Case c(trial.seed(), trial.size, kRhos[trial.variant], 1.3f);
                                       return run_on<vulkan::ConjugateDirection>(
                                           kernels, {trial.size}, 1, {{c.next_direction, trial.variant != 0}}, c.rho,
                                           c.next_rho, c.y, c.direction);
                                     }});

TEST(ConjugateDirectionReference, EqualsTheTextbook) {
  const Case c(100, 100, 2.5f, 1.5f);
  for (std::size_t k = 0; k < 100; ++k) {
    EXPECT_NEAR(c.next_direction[k], c.y[k] + 0.6 * static_cast<double>(c.direction[k]), 2e-7);
  }
  // The first direction is that of y.
  const Case first(100, 100, 0, 1.5f);
  EXPECT_EQ(first.next_direction, first.y);
}

}  // namespace conjugate_direction_test
}  // namespace bodyopt::testing
