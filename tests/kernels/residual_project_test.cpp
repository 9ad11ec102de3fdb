#include "runtime/core/half.h"
#include "runtime/cpu/kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace residual_project_test {

constexpr std::uint32_t kFeatures = 23;

// As many regions as it takes; the coordinates come out as they do.
struct Case {
  Case(std::uint32_t coefficients, std::uint32_t frame_count)
      : random(coefficients + 31 * frame_count),
        frames(frame_count),
        residual(random_residual(random, kFeatures, 0, coefficients, 0)),
        features(random.floats(std::size_t{kFeatures} * frames, -2, 2)),
        coordinates(std::size_t{residual.coordinate_count()} * frames) {
    cpu::residual_project(residual, features, frames, coordinates);
  }

  // Sums and products in one order, without contraction.
  KernelRun on(KernelSet& kernels) const {
    return run_on<vulkan::ResidualProject>(kernels, {residual.coordinate_count(), kFeatures}, frames, {{coordinates}},
                                           residual.regions, residual.region_features, residual.coordinate_region,
                                           residual.projections, features);
  }

  Random random;
  std::uint32_t frames;
  ResidualTable residual;
  std::vector<float> features;
  std::vector<float> coordinates;  // by the reference
};

class ResidualProject : public GpuTest {};

const bool added = add_kernel_cases_of_frames(
    "residual_project", "coefficients",
    [](KernelSet& kernels, const Trial& trial) { return Case(trial.size, trial.variant).on(kernels); });

// Rows of an odd number of halves end in one that means nothing.
TEST_F(ResidualProject, UnusedHalvesAreNotRead) {
  Case c(200, 2);
  bool any = false;
  for (const Region& region : c.residual.regions) {
    const std::size_t row_words = (region.feature_count + 1) / 2;
    for (std::size_t k = 0; region.feature_count % 2 == 1 && k < region.coordinate_count; ++k) {
      c.residual.projections[region.projection_values + (k + 1) * row_words - 1] |= half_from_float(-1.5f) << 16;
      any = true;
    }
  }
  ASSERT_TRUE(any);
  std::vector<float> coordinates(c.coordinates.size());
  cpu::residual_project(c.residual, c.features, c.frames, coordinates);
  EXPECT_EQ(coordinates, c.coordinates);
  KernelSet kernels(*device_);
  expect_reference(*device_, "residual_project", c.on(kernels));
}

TEST_F(ResidualProject, ReferenceEqualsTheTextbook) {
  const Case c(100, 2);
  ASSERT_GT(c.residual.coordinate_count(), 20u);
  for (std::uint32_t f = 0; f < c.frames; ++f) {
    std::size_t at = 0;
    for (const Region& region : c.residual.regions) {
      for (std::size_t k = 0; k < region.coordinate_count; ++k, ++at) {
        double sum = 0;
        for (std::size_t i = 0; i < region.feature_count; ++i) {
          sum += double{projection_value(c.residual, region, k, i)} *
                 double{c.features[kFeatures * f + c.residual.region_features[region.feature_begin + i]]};
        }
        ASSERT_NEAR(c.coordinates[std::size_t{c.residual.coordinate_count()} * f + at], sum, 2e-6);
      }
    }
    ASSERT_EQ(at, c.residual.coordinate_count());
  }
}

}  // namespace residual_project_test
}  // namespace bodyopt::testing
