#include "runtime/core/error.h"
#include "runtime/cpu/kernels.h"
#include "runtime/vulkan/kernels/windows.h"
#include "tests/support/gpu_fixture.h"
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

  std::vector<float> on_gpu(const vulkan::Device& device, const vulkan::DeviceInfo& limits) const {
    const vulkan::PoseSkin kernel(device);
    const vulkan::DdmBuffers table(device, ddm, limits);
    const auto s = vulkan::upload(device, skinning, "skinning"), o = vulkan::upload(device, origins, "origins"),
               d = vulkan::upload(device, displacements, "displacements");
    return run_kernel(device, {displacements.size()}, [&](auto& commands, const auto& outputs) {
      vulkan::record_pose_skin(commands, kernel, {table, s, o, d, outputs[0]}, vertices, kJoints, frames);
    })[0];
  }

  Random random;
  std::uint32_t vertices, frames;
  DdmTable ddm;
  std::vector<float> skinning, origins, displacements;
};

class PoseSkin : public GpuTest {};

// 1e-6 m: a few roundings of metres and the rotation's 1e-6 on an offset of centimetres; then a rounding of the origin.
constexpr double kAbsolute = 1e-6, kRelative = 1.2e-7;

TEST_F(PoseSkin, EqualsTheReference) {
  for (const std::uint32_t vertices : kSizes) {
    for (const std::uint32_t frames : kFrames) {
      SCOPED_TRACE(std::to_string(vertices) + " vertices, " + std::to_string(frames) + " frames");
      const Case c(vertices, frames);
      expect_close(c.on_gpu(*device_, device_->info()), c.on_cpu(), kAbsolute, kRelative);
    }
  }
}

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
        ASSERT_NEAR(positions[at + static_cast<std::size_t>(i)], world, 2e-6 + kRelative * std::abs(world))
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
  const std::vector<float> positions = c.on_gpu(*device_, device_->info());
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
  expect_same_bits_through_windows(
      device_->info(), c.vertices, {3600, 10000, 100000},
      [&](const auto& limits) { return vulkan::DdmBuffers(*device_, c.ddm, limits).windows; },
      [&](const auto& limits) { return c.on_gpu(*device_, limits); });
}

}  // namespace pose_skin_test
}  // namespace bodyopt::testing
