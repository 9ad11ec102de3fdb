#include "runtime/core/error.h"
#include "runtime/cpu/kernels.h"
#include "runtime/vulkan/kernels/windows.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_tables.h"
#include "tests/support/small_windows.h"
#include "tests/support/textbook_ddm.h"

namespace bodyopt::testing {
namespace pose_skin_test {

constexpr std::uint32_t kJoints = 7;

struct Case {
  Case(std::uint32_t vertex_count, std::uint32_t frame_count)
      : random(vertex_count + 31 * frame_count),
        vertices(vertex_count),
        frames(frame_count),
        ddm(random_ddm(random, vertices, kJoints)),
        skinning(random_skinning(random, kJoints, frames, 0.8)),
        origins(random.floats(4 * frames, -100, 100)),
        displacements(random.floats(std::size_t{3} * frames * vertices, -0.01, 0.01)) {}

  std::vector<float> on_cpu() const {
    std::vector<float> positions(displacements.size());
    cpu::pose_skin(ddm, kJoints, skinning, origins, displacements, positions);
    return positions;
  }

  KernelRun on(KernelSet& kernels, const vulkan::DeviceInfo& limits) const {
    const vulkan::Device& device = kernels.device();
    struct Bound {
      vulkan::DdmBuffers table;
      vulkan::Buffer skinning, origins, displacements;
    };
    const auto bound = std::make_shared<const Bound>(Bound{
        vulkan::upload_together<vulkan::DdmBuffers>(device, ddm, limits), vulkan::upload(device, skinning, "skinning"),
        vulkan::upload(device, origins, "origins"), vulkan::upload(device, displacements, "displacements")});
    return {{{on_cpu()}},
            [&kernel = kernels.get<vulkan::PoseSkin>(), bound, vertices = vertices, frames = frames](
                vulkan::Commands& commands, const auto& outputs) {
              const auto& [table, s, o, d] = *bound;
              vulkan::record_pose_skin(commands, kernel, {table, s, o, d, outputs[0]}, vertices, kJoints, frames);
            }};
  }

  Random random;
  std::uint32_t vertices, frames;
  DdmTable ddm;
  std::vector<float> skinning, origins, displacements;
};

class PoseSkin : public GpuTest {};

const bool added = add_kernel_cases_of_frames("pose_skin", "vertices", [](KernelSet& kernels, const Trial& trial) {
  return Case(trial.size, trial.variant).on(kernels, kernels.device().info());
});

TEST_F(PoseSkin, ReferenceEqualsTheTextbook) {
  Case c(1237, 2);
  const std::vector<float> positions = c.on_cpu();
  std::size_t skipped = 0;
  for (std::uint32_t f = 0; f < c.frames; ++f) {
    for (std::uint32_t v = 0; v < c.vertices; ++v) {
      const std::size_t at = 3 * (std::size_t{f} * c.vertices + v);
      const Eigen::Vector3d delta(c.displacements[at], c.displacements[at + 1], c.displacements[at + 2]);
      const auto [expected, gap] = textbook_ddm(c.ddm, v, c.skinning.data() + 12 * kJoints * f, delta);
      if (gap < 0.05) {
        ++skipped;
        continue;
      }
      for (int i = 0; i < 3; ++i) {
        const double world = expected[i] + static_cast<double>(c.origins[4 * f + static_cast<std::size_t>(i)]);
        ASSERT_NEAR(positions[at + static_cast<std::size_t>(i)], world, 2e-6 + 1.2e-7 * std::abs(world))
            << "vertex " << v << ", gap " << gap;
      }
    }
  }
  EXPECT_LT(skipped, 1237u * 2 / 20);
}

// One rigid transform for all joints moves every vertex rigidly, up to roundings.
TEST_F(PoseSkin, RigidMotionStaysRigid) {
  Case c(65, 1);
  const std::vector<float> one = random_skinning(c.random, 1, 1, 3.0);
  for (std::size_t k = 0; k < c.skinning.size(); ++k) c.skinning[k] = one[k % 12];
  std::fill(c.displacements.begin(), c.displacements.end(), 0.0f);
  std::fill(c.origins.begin(), c.origins.end(), 0.0f);
  KernelSet kernels(*device_);
  const std::vector<float> positions = outputs_of(*device_, c.on(kernels, device_->info()))[0];
  for (std::uint32_t v = 0; v < c.vertices; ++v) {
    const DdmVertex& d = c.ddm.vertices[v];
    const double rest[3] = {static_cast<double>(d.centre_x) + d.offset_x, static_cast<double>(d.centre_y) + d.offset_y,
                            static_cast<double>(d.centre_z) + d.offset_z};
    for (std::size_t i = 0; i < 3; ++i) {
      const double expected =
          one[4 * i] * rest[0] + one[4 * i + 1] * rest[1] + one[4 * i + 2] * rest[2] + one[4 * i + 3];
      EXPECT_NEAR(positions[3 * v + i], expected, 4e-7);
    }
  }
}

TEST_F(PoseSkin, WindowsGiveTheSameBits) {
  const Case c(1237, 2);
  KernelSet kernels(*device_);
  expect_same_bits_through_windows(
      device_->info(), c.vertices, {3600, 10000, 100000},
      [&](const auto& limits) { return vulkan::upload_together<vulkan::DdmBuffers>(*device_, c.ddm, limits).windows; },
      [&](const auto& limits) { return outputs_of(*device_, c.on(kernels, limits))[0]; });
}

}  // namespace pose_skin_test
}  // namespace bodyopt::testing
