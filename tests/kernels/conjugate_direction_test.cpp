#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace conjugate_direction_test {

struct Case {
  Case(std::uint32_t count, float rho_, float next_rho_)
      : random(count),
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

class ConjugateDirection : public GpuTest {};

TEST_F(ConjugateDirection, EqualsTheReference) {
  const vulkan::ConjugateDirection kernel(*device_);
  for (const std::uint32_t count : kSizes) {
    for (const float rho : {1.7f, 0.0f}) {
      SCOPED_TRACE(std::to_string(count) + " numbers, rho " + std::to_string(rho));
      const Case c(count, rho, 1.3f);
      const auto rho_buffer = vulkan::upload(*device_, c.rho, "rho"),
                 next_rho = vulkan::upload(*device_, c.next_rho, "next rho"), y = vulkan::upload(*device_, c.y, "y"),
                 direction = vulkan::upload(*device_, c.direction, "direction");
      const auto outputs = run_kernel(*device_, {count}, [&](auto& commands, const auto& out) {
        kernel.record(commands, {rho_buffer, next_rho, y, direction, out[0]}, {count});
      });
      expect_close(outputs[0], c.next_direction, rho > 0 ? 5e-7 : 0);  // a division of a few ulp
    }
  }
}

TEST(ConjugateDirectionReference, EqualsTheTextbook) {
  const Case c(100, 2.5f, 1.5f);
  for (std::size_t k = 0; k < 100; ++k) {
    EXPECT_NEAR(c.next_direction[k], c.y[k] + 0.6 * static_cast<double>(c.direction[k]), 2e-7);
  }
  // The first direction is that of y.
  const Case first(100, 0, 1.5f);
  EXPECT_EQ(first.next_direction, first.y);
}

}  // namespace conjugate_direction_test
}  // namespace bodyopt::testing
