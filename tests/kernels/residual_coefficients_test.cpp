#include "runtime/cpu/kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace residual_coefficients_test {

constexpr std::uint32_t kFeatures = 23;

struct Case {
  Case(std::uint32_t count, std::uint32_t frame_count)
      : random(count + 31 * frame_count),
        frames(frame_count),
        residual(random_residual(random, kFeatures, count / 2, count, 0)),
        coordinates(random.floats(std::size_t{residual.coordinate_count()} * frames, -2, 2)),
        kernels(random.floats(std::size_t{residual.centre_count()} * frames, 0, 1)),
        rest(random.floats(count, -1, 1)),
        fades(random.floats(residual.regions.size() * frames, 0, 1)),
        coefficients(std::size_t{count} * frames) {
    cpu::residual_coefficients(residual, coordinates, kernels, rest, fades, frames, coefficients);
  }

  Random random;
  std::uint32_t frames;
  ResidualTable residual;
  std::vector<float> coordinates, kernels, rest, fades;
  std::vector<float> coefficients;  // by the reference
};

const bool added =
    add_kernel_cases_of_frames("residual_coefficients", "coefficients", [](KernelSet& kernels, const Trial& trial) {
      const Case c(trial.size, trial.variant);
      const ResidualTable& t = c.residual;
      // Sums and products in one order, without contraction.
      return run_on<vulkan::ResidualCoefficients>(
          kernels, {trial.size, t.coordinate_count(), t.centre_count(), static_cast<std::uint32_t>(t.regions.size())},
          c.frames, {{c.coefficients}}, t.regions, t.coefficient_region, t.weights, c.rest, c.coordinates, c.kernels,
          c.fades);
    });

TEST(ResidualCoefficientsReference, EqualsTheTextbook) {
  const Case c(100, 2);
  for (std::uint32_t f = 0; f < c.frames; ++f) {
    std::size_t row = 0, at = 0;
    for (std::size_t r = 0; r < c.residual.regions.size(); ++r) {
      const Region& region = c.residual.regions[r];
      const double fade{c.fades[c.residual.regions.size() * f + r]};
      std::vector<double> input = {1};
      for (std::uint32_t k = 0; k < region.coordinate_count; ++k) {
        input.push_back(c.coordinates[std::size_t{c.residual.coordinate_count()} * f + region.coordinate_begin + k]);
      }
      for (std::uint32_t m = 0; m < region.centre_count; ++m) {
        input.push_back(c.kernels[std::size_t{c.residual.centre_count()} * f + region.centre_begin + m]);
      }
      for (std::uint32_t k = 0; k < region.coefficient_count; ++k, ++at) {
        double sum = -static_cast<double>(c.rest[at]);
        for (const double x : input) sum += c.residual.weights[row++] * x;
        ASSERT_NEAR(c.coefficients[100 * f + at], fade * sum, 5e-6);
      }
    }
    ASSERT_EQ(at, 100u);
  }
}

}  // namespace residual_coefficients_test
}  // namespace bodyopt::testing
