#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace conjugate_dot_test {

struct Case {
  explicit Case(std::uint32_t count) : random(count), a(random.floats(count, -1, 1)), b(random.floats(count, -1, 1)) {
    cpu::conjugate_dot(a, b, sum);
  }

  Random random;
  std::vector<float> a, b;
  std::vector<float> sum = {7};  // by the reference
};

const bool added = add_kernel_cases("conjugate_dot", "numbers", [](KernelSet& kernels, const Trial& trial) {
  const Case c(trial.size);
  // Sums and products in one order.
  return run_on<vulkan::ConjugateDot>(kernels, {trial.size}, 1, {{c.sum}}, c.a, c.b);
});

TEST(ConjugateDotReference, EqualsTheTextbook) {
  for (const std::uint32_t count : kSizes) {
    const Case c(count);
    double sum = 0;
    for (std::size_t k = 0; k < count; ++k) sum += static_cast<double>(c.a[k]) * static_cast<double>(c.b[k]);
    EXPECT_NEAR(c.sum[0], sum, 1e-7 * count) << count << " numbers";
  }
}

}  // namespace conjugate_dot_test
}  // namespace bodyopt::testing
