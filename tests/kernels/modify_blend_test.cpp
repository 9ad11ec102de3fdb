#include "runtime/core/half.h"
#include "runtime/cpu/kernels.h"
#include "runtime/vulkan/kernels/windows.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_tables.h"
#include "tests/support/small_windows.h"

namespace bodyopt::testing {
namespace modify_blend_test {

constexpr std::uint32_t kComponents = 40;

struct Case {
  Case(std::uint32_t vertex_count, std::uint32_t frame_count)
      : random(vertex_count + 31 * frame_count),
        vertices(vertex_count),
        frames(frame_count),
        weights(random.floats(std::size_t{kComponents} * frames, -2, 2)),
        displacements(random.floats(std::size_t{3} * vertices * frames, -0.01, 0.01)),
        modified(displacements) {
    const ResidualTable table = random_residual(random, 10, 100, kComponents, vertices);
    modifiers.blend_begin = table.blend_begin;
    modifiers.blend = table.blend;
    cpu::modify_blend(modifiers, weights, frames, modified);
  }

  vulkan::BlendBuffers blend_on(const vulkan::Device& device, const vulkan::DeviceInfo& limits) const {
    return vulkan::upload_together<vulkan::BlendBuffers>(device, modifiers.blend_begin, modifiers.blend, limits);
  }

  KernelRun on(KernelSet& kernels, const vulkan::DeviceInfo& limits) const {
    const vulkan::Device& device = kernels.device();
    struct Bound {
      vulkan::BlendBuffers blend;
      vulkan::Buffer weights;
    };
    const auto bound =
        std::make_shared<const Bound>(Bound{blend_on(device, limits), vulkan::upload(device, weights, "weights")});
    return {{{.values = modified,
              .before = displacements}},  // in place; sums and products in one order; numbers convert exactly
            [&kernel = kernels.get<vulkan::ModifyBlend>(), bound, vertices = vertices, frames = frames](
                vulkan::Commands& commands, const auto& outputs) {
              const auto& [blend, w] = *bound;
              vulkan::record_modify_blend(commands, kernel, {blend, w, outputs[0]}, vertices, kComponents, frames);
            }};
  }

  Random random;
  std::uint32_t vertices, frames;
  SkinModifiers modifiers;
  std::vector<float> weights, displacements, modified;  // the last by the reference
};

class ModifyBlend : public GpuTest {};

const bool added = add_kernel_cases_of_frames("modify_blend", "vertices", [](KernelSet& kernels, const Trial& trial) {
  return Case(trial.size, trial.variant).on(kernels, kernels.device().info());
});

TEST_F(ModifyBlend, ReferenceEqualsTheTextbook) {
  const Case c(200, 2);
  for (std::size_t k = 0; k < c.modified.size() / 3; ++k) {
    const std::size_t vertex = k % 200, frame = k / 200, block = vertex / kBlockSize, lane = vertex % kBlockSize;
    for (std::size_t i = 0; i < 3; ++i) {
      double expected = static_cast<double>(c.displacements[3 * k + i]);
      for (std::uint32_t e = c.modifiers.blend_begin[block]; e < c.modifiers.blend_begin[block + 1]; ++e) {
        const BlendEntry& entry = c.modifiers.blend[e];
        const std::size_t byte = kBlockSize * i + lane;
        const auto number = static_cast<std::int8_t>(entry.numbers[byte / 4] >> 8 * (byte % 4) & 255);
        expected += static_cast<double>(c.weights[kComponents * frame + (entry.scale_coefficient >> 16)]) *
                    static_cast<double>(float_from_half(entry.scale_coefficient & 0xffff)) * number / 128;
      }
      ASSERT_NEAR(c.modified[3 * k + i], expected, 2e-8);
    }
  }
}

TEST_F(ModifyBlend, WeightsOfZeroChangeNoBit) {
  Case c(1237, 1);
  std::vector<float> displacements = c.displacements;
  cpu::modify_blend(c.modifiers, std::vector<float>(kComponents, 0.0f), 1, displacements);
  EXPECT_EQ(displacements, c.displacements);
}

TEST_F(ModifyBlend, WindowsGiveTheSameBits) {
  const Case c(1237, 2);
  KernelSet kernels(*device_);
  expect_same_bits_through_windows(
      device_->info(), c.vertices, {4000, 8000},
      [&](const auto& limits) { return c.blend_on(*device_, limits).windows; },
      [&](const auto& limits) { return outputs_of(*device_, c.on(kernels, limits))[0]; });
}

}  // namespace modify_blend_test
}  // namespace bodyopt::testing
