#include "runtime/cpu/kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace residual_features_test {

// `count` features: about half from joints, the rest from strains and controls.
struct Case {
  Case(std::uint32_t count, std::uint32_t frame_count)
      : random(count + 31 * frame_count),
        frames(frame_count),
        controls_count(count / 5),
        strain_count(count / 3),
        joint_count(count - strain_count - controls_count),
        residual(random_residual(random, count, 0, 0, 0)),
        joints(random.floats(std::size_t{joint_count} * frames, -2, 2)),
        strains(random.floats(std::size_t{strain_count} * frames, -2, 2)),
        controls(random.floats(std::size_t{controls_count} * frames, -2, 2)),
        features(std::size_t{count} * frames),
        excess(features.size()) {
    for (std::uint32_t k = 0; k < controls_count; ++k) residual.controls.push_back("control " + std::to_string(k));
    cpu::residual_features(residual.features, joints, strains, controls, frames, features, excess);
  }

  Random random;
  std::uint32_t frames, controls_count, strain_count, joint_count;
  ResidualTable residual;
  std::vector<float> joints, strains, controls;
  std::vector<float> features, excess;  // by the reference
};

class ResidualFeatures : public GpuTest {};

TEST_F(ResidualFeatures, EqualsTheReference) {
  const vulkan::ResidualFeatures kernel(*device_);
  for (const std::uint32_t count : kSizes) {
    for (const std::uint32_t frames : kFrames) {
      SCOPED_TRACE(std::to_string(count) + " features, " + std::to_string(frames) + " frames");
      const Case c(count, frames);
      const auto ranges = vulkan::upload(*device_, c.residual.features, "ranges"),
                 joints = vulkan::upload(*device_, c.joints, "joints"),
                 strains = vulkan::upload(*device_, c.strains, "strains"),
                 controls = vulkan::upload(*device_, c.controls, "controls");
      const auto outputs = run_kernel(*device_, {c.features.size(), c.excess.size()}, [&](auto& commands, auto& out) {
        kernel.record(commands, {ranges, joints, strains, controls, out[0], out[1]},
                      {c.joint_count, c.strain_count, c.controls_count}, frames);
      });
      expect_close(outputs[0], c.features, 0);  // a subtraction and a product, each correctly rounded everywhere
      expect_close(outputs[1], c.excess, 0);
    }
  }
}

TEST_F(ResidualFeatures, ReferenceEqualsTheTextbook) {
  const Case c(100, 3);
  for (std::uint32_t f = 0; f < c.frames; ++f) {
    std::vector<float> raw(c.joints.begin() + f * c.joint_count, c.joints.begin() + (f + 1) * c.joint_count);
    raw.insert(raw.end(), c.strains.begin() + f * c.strain_count, c.strains.begin() + (f + 1) * c.strain_count);
    raw.insert(raw.end(), c.controls.begin() + f * c.controls_count, c.controls.begin() + (f + 1) * c.controls_count);
    ASSERT_EQ(raw.size(), 100u);
    for (std::size_t k = 0; k < raw.size(); ++k) {
      const FeatureRange& range = c.residual.features[k];
      const double value = raw[k], inside = std::clamp<double>(value, range.low, range.high);
      ASSERT_NEAR(c.features[100 * f + k], (inside - range.mean) * range.inverse_scale, 1e-6);
      ASSERT_NEAR(c.excess[100 * f + k], std::abs(value - inside) * range.inverse_scale, 1e-6);
    }
  }
}

}  // namespace residual_features_test
}  // namespace bodyopt::testing
