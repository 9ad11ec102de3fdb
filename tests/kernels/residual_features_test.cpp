#include "runtime/cpu/kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/kernel_cases.h"
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

const bool added =
    add_kernel_cases_of_frames("residual_features", "features", [](KernelSet& kernels, const Trial& trial) {
      const Case c(trial.size, trial.variant);
      // A subtraction and a product, each correctly rounded everywhere.
      return run_on<vulkan::ResidualFeatures>(kernels, {c.joint_count, c.strain_count, c.controls_count}, c.frames,
                                              {{c.features}, {c.excess}}, c.residual.features, c.joints, c.strains,
                                              c.controls);
    });

TEST(ResidualFeaturesReference, EqualsTheTextbook) {
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
