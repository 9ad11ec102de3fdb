#include "runtime/cpu/kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace modify_blend_test {

constexpr std::uint32_t kComponents = 40;

struct Case {
  Case(std::uint32_t vertices, std::uint32_t frame_count)
      : random(vertices + 31 * frame_count),
        frames(frame_count),
        weights(random.floats(std::size_t{kComponents} * frames, -2, 2)),
        displacements(random.floats(std::size_t{3} * vertices * frames, -0.01, 0.01)),
        modified(displacements) {
    const ResidualTable table = random_residual(random, 10, 100, kComponents, vertices);
    modifiers.blend_begin = table.blend_begin;
    modifiers.blend = table.blend;
    cpu::modify_blend(modifiers, weights, frames, modified);
  }

  Random random;
  std::uint32_t frames;
  SkinModifiers modifiers;
  std::vector<float> weights, displacements, modified;  // the last by the reference
};

class ModifyBlend : public GpuTest {};

TEST_F(ModifyBlend, EqualsTheReference) {
  const vulkan::ModifyBlend kernel(*device_);
  for (const std::uint32_t vertices : kSizes) {
    for (const std::uint32_t frames : kFrames) {
      SCOPED_TRACE(std::to_string(vertices) + " vertices, " + std::to_string(frames) + " frames");
      const Case c(vertices, frames);
      const auto begin = vulkan::upload(*device_, c.modifiers.blend_begin, "begin"),
                 blend = vulkan::upload(*device_, c.modifiers.blend, "blend"),
                 weights = vulkan::upload(*device_, c.weights, "weights"),
                 displacements = vulkan::upload(*device_, c.displacements, "displacements");
      const auto outputs = run_kernel(*device_, {c.modified.size()}, [&](auto& commands, const auto& out) {
        commands.copy({displacements, 0, sizeof(float) * c.displacements.size()}, out[0]);
        commands.barrier();
        kernel.record(commands, {begin, blend, weights, out[0]}, {vertices, kComponents}, frames);
      });
      expect_close(outputs[0], c.modified, 0);  // sums and products in one order; numbers convert exactly
    }
  }
}

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

}  // namespace modify_blend_test
}  // namespace bodyopt::testing
