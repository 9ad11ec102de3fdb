#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/gpu_fixture.h"
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

class ConjugateDot : public GpuTest {};

TEST_F(ConjugateDot, EqualsTheReference) {
  const vulkan::ConjugateDot kernel(*device_);
  for (const std::uint32_t count : kSizes) {
    SCOPED_TRACE(std::to_string(count) + " numbers");
    const Case c(count);
    const auto a = vulkan::upload(*device_, c.a, "a"), b = vulkan::upload(*device_, c.b, "b");
    const auto outputs = run_kernel(*device_, {1}, [&](auto& commands, const auto& out) {
      kernel.record(commands, {a, b, out[0]}, {count});
    });
    expect_close(outputs[0], c.sum, 0);  // sums and products in one order
  }
}

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
