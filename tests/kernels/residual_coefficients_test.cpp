#include "runtime/cpu/kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/gpu_fixture.h"
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

class ResidualCoefficients : public GpuTest {};

TEST_F(ResidualCoefficients, EqualsTheReference) {
  const vulkan::ResidualCoefficients kernel(*device_);
  for (const std::uint32_t count : kSizes) {
    for (const std::uint32_t frames : kFrames) {
      SCOPED_TRACE(std::to_string(count) + " coefficients, " + std::to_string(frames) + " frames");
      const Case c(count, frames);
      const auto regions = vulkan::upload(*device_, c.residual.regions, "regions"),
                 coefficient_region = vulkan::upload(*device_, c.residual.coefficient_region, "coefficient regions"),
                 weights = vulkan::upload(*device_, c.residual.weights, "weights"),
                 rest = vulkan::upload(*device_, c.rest, "rest"),
                 coordinates = vulkan::upload(*device_, c.coordinates, "coordinates"),
                 fades = vulkan::upload(*device_, c.fades, "fades"),
                 kernels = vulkan::upload(*device_, c.kernels, "kernels");
      const auto outputs = run_kernel(*device_, {c.coefficients.size()}, [&](auto& commands, const auto& out) {
        kernel.record(commands, {regions, coefficient_region, weights, rest, coordinates, kernels, fades, out[0]},
                      {count, c.residual.coordinate_count(), c.residual.centre_count(),
                       static_cast<std::uint32_t>(c.residual.regions.size())},
                      frames);
      });
      expect_close(outputs[0], c.coefficients, 0);  // sums and products in one order, without contraction
    }
  }
}

TEST_F(ResidualCoefficients, ReferenceEqualsTheTextbook) {
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
