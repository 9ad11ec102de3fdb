#include "runtime/cpu/kernels.h"
#include "runtime/vulkan/kernels/windows.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_tables.h"
#include "tests/support/textbook_ddm.h"

namespace bodyopt::testing {
namespace strain_skin_test {

constexpr std::uint32_t kJoints = 5, kVertices = 300;

struct Case {
  Case(std::uint32_t points, std::uint32_t frame_count)
      : random(points + 31 * frame_count),
        frames(frame_count),
        ddm(random_ddm(random, kVertices, kJoints)),
        strain(random_strain(random, points == 0 ? 0 : 3, points, kVertices)),
        skinning(random_skinning(random, kJoints, frames, 0.8)) {}

  std::size_t count() const { return 3 * frames * strain.vertices.size(); }

  std::vector<float> on_cpu() const {
    std::vector<float> positions(count());
    cpu::strain_skin(ddm, strain, kJoints, skinning, positions);
    return positions;
  }

  KernelRun on(KernelSet& kernels, const vulkan::DeviceInfo& limits) const {
    const vulkan::Device& device = kernels.device();
    struct Bound {
      vulkan::DdmBuffers table;
      vulkan::Buffer skinning, vertices;
    };
    const auto bound = std::make_shared<const Bound>(
        Bound{vulkan::upload_together<vulkan::DdmBuffers>(device, ddm, limits),
              vulkan::upload(device, skinning, "skinning"), vulkan::upload(device, strain.vertices, "vertices")});
    return {{{on_cpu()}},
            [&kernel = kernels.get<vulkan::StrainSkin>(), bound, points = strain.vertices.size(), frames = frames](
                vulkan::Commands& commands, const auto& outputs) {
              const auto& [table, s, v] = *bound;
              vulkan::record_strain_skin(commands, kernel, {table, s, v, outputs[0]},
                                         static_cast<std::uint32_t>(points), kJoints, frames);
            }};
  }

  Random random;
  std::uint32_t frames;
  DdmTable ddm;
  StrainTable strain;
  std::vector<float> skinning;
};

class StrainSkin : public GpuTest {};

const bool added = add_kernel_cases_of_frames("strain_skin", "points", [](KernelSet& kernels, const Trial& trial) {
  return Case(trial.size, trial.variant).on(kernels, kernels.device().info());
});

TEST_F(StrainSkin, ReferenceEqualsTheTextbook) {
  const Case c(200, 2);
  const std::vector<float> positions = c.on_cpu();
  const std::size_t points = c.strain.vertices.size();
  std::size_t compared = 0;
  for (std::size_t k = 0; k < points * c.frames; ++k) {
    const float* skinning = c.skinning.data() + 12 * kJoints * (k / points);
    const auto [expected, gap] = textbook_ddm(c.ddm, c.strain.vertices[k % points], skinning, Eigen::Vector3d::Zero());
    if (gap < 0.05) continue;
    ++compared;
    for (std::size_t i = 0; i < 3; ++i) ASSERT_NEAR(positions[3 * k + i], expected[static_cast<int>(i)], 2e-6);
  }
  EXPECT_GT(compared, points * c.frames * 19 / 20);
}

TEST_F(StrainSkin, WindowsGiveTheSameBits) {
  const Case c(130, 2);
  vulkan::DeviceInfo limits = device_->info();
  limits.max_storage_buffer_range = 10000;
  ASSERT_GT(vulkan::upload_together<vulkan::DdmBuffers>(*device_, c.ddm, limits).windows.size(), 1u);
  KernelSet kernels(*device_);
  EXPECT_EQ(outputs_of(*device_, c.on(kernels, limits)), outputs_of(*device_, c.on(kernels, device_->info())));
}

}  // namespace strain_skin_test
}  // namespace bodyopt::testing
