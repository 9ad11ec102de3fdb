#include "runtime/cpu/kernels.h"
#include "runtime/vulkan/kernels/windows.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_tables.h"
#include "tests/support/small_windows.h"

namespace bodyopt::testing {
namespace residual_blend_test {

constexpr std::uint32_t kCoefficients = 300;
constexpr float kWeight = 0.7f;

struct Case {
  Case(std::uint32_t vertex_count, std::uint32_t frame_count)
      : random(vertex_count + 31 * frame_count),
        vertices(vertex_count),
        frames(frame_count),
        residual(random_residual(random, 10, 100, kCoefficients, vertices)),
        coefficients(random.floats(std::size_t{kCoefficients} * frames, -2, 2)),
        displacements(std::size_t{3} * vertices * frames) {
    cpu::residual_blend(residual, coefficients, frames, kWeight, displacements);
  }

  vulkan::BlendBuffers blend_on(const vulkan::Device& device, const vulkan::DeviceInfo& limits) const {
    return vulkan::upload_together<vulkan::BlendBuffers>(device, residual.blend_begin, residual.blend, limits);
  }

  KernelRun on(KernelSet& kernels, const vulkan::DeviceInfo& limits) const {
    const vulkan::Device& device = kernels.device();
    struct Bound {
      vulkan::BlendBuffers blend;
      vulkan::Buffer coefficients;
    };
    const auto bound = std::make_shared<const Bound>(
        Bound{blend_on(device, limits), vulkan::upload(device, coefficients, "coefficients")});
    return {{{displacements}},  // sums and products in one order; numbers convert exactly
            [&kernel = kernels.get<vulkan::ResidualBlend>(), bound, vertices = vertices, frames = frames](
                vulkan::Commands& commands, const auto& outputs) {
              const auto& [blend, c] = *bound;
              vulkan::record_residual_blend(commands, kernel, {blend, c, outputs[0]}, vertices, kCoefficients, kWeight,
                                            frames);
            }};
  }

  Random random;
  std::uint32_t vertices, frames;
  ResidualTable residual;
  std::vector<float> coefficients;
  std::vector<float> displacements;  // by the reference
};

// Value of a half, by its definition.
double half_value(std::uint32_t bits) {
  const int exponent = static_cast<int>(bits >> 10 & 31), mantissa = static_cast<int>(bits & 1023);
  const double magnitude = exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25);
  return bits >> 15 & 1 ? -magnitude : magnitude;
}

// Signed byte k of the numbers, by its definition.
int byte_value(const BlendEntry& entry, std::size_t k) {
  const int byte = static_cast<int>(entry.numbers[k / 4] >> 8 * (k % 4) & 255);
  return byte < 128 ? byte : byte - 256;
}

class ResidualBlend : public GpuTest {};

const bool added = add_kernel_cases_of_frames("residual_blend", "vertices", [](KernelSet& kernels, const Trial& trial) {
  return Case(trial.size, trial.variant).on(kernels, kernels.device().info());
});

TEST_F(ResidualBlend, ReferenceEqualsTheTextbook) {
  const Case c(200, 2);
  for (std::size_t k = 0; k < c.displacements.size() / 3; ++k) {
    const std::size_t vertex = k % 200, frame = k / 200;
    double sum[3] = {};
    const std::size_t block = vertex / 16, lane = vertex % 16;
    for (std::uint32_t e = c.residual.blend_begin[block]; e < c.residual.blend_begin[block + 1]; ++e) {
      const BlendEntry& entry = c.residual.blend[e];
      const double scale = half_value(entry.scale_coefficient % 65536);
      const double coefficient = c.coefficients[kCoefficients * frame + entry.scale_coefficient / 65536];
      for (std::size_t i = 0; i < 3; ++i) sum[i] += coefficient * scale * byte_value(entry, 16 * i + lane) / 128;
    }
    for (std::size_t i = 0; i < 3; ++i)
      ASSERT_NEAR(c.displacements[3 * k + i], static_cast<double>(kWeight) * sum[i], 2e-8);
  }
}

TEST_F(ResidualBlend, WindowsGiveTheSameBits) {
  const Case c(1237, 2);
  KernelSet kernels(*device_);
  expect_same_bits_through_windows(
      device_->info(), c.vertices, {4000, 8000},
      [&](const auto& limits) { return c.blend_on(*device_, limits).windows; },
      [&](const auto& limits) { return outputs_of(*device_, c.on(kernels, limits))[0]; });
}

}  // namespace residual_blend_test
}  // namespace bodyopt::testing
