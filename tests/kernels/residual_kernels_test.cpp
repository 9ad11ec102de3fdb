#include "runtime/core/half.h"
#include "runtime/cpu/kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace residual_kernels_test {

constexpr std::uint32_t kFeatures = 23;

struct Case {
  Case(std::uint32_t centres, std::uint32_t frame_count)
      : random(centres + 31 * frame_count),
        frames(frame_count),
        residual(random_residual(random, kFeatures, centres, 0, 0)),
        coordinates(random.floats(std::size_t{residual.coordinate_count()} * frames, -2, 2)),
        kernels(std::size_t{centres} * frames) {
    cpu::residual_kernels(residual, coordinates, frames, kernels);
  }

  bool has_rows(bool odd) const {
    return std::any_of(residual.regions.begin(), residual.regions.end(),
                       [&](const Region& r) { return r.centre_count > 0 && (r.coordinate_count % 2 == 1) == odd; });
  }

  KernelRun on(KernelSet& set) const {
    return run_on<vulkan::ResidualKernels>(set, {residual.centre_count(), residual.coordinate_count()}, frames,
                                           {{kernels}}, residual.regions, residual.centre_region, residual.centres,
                                           coordinates);
  }

  Random random;
  std::uint32_t frames;
  ResidualTable residual;
  std::vector<float> coordinates;
  std::vector<float> kernels;  // by the reference
};

class ResidualKernels : public GpuTest {};

const bool added = add_kernel_cases_of_frames(
    "residual_kernels", "centres",
    [](KernelSet& kernels, const Trial& trial) { return Case(trial.size, trial.variant).on(kernels); });

// Rows of an odd number of halves end in one that means nothing.
TEST_F(ResidualKernels, UnusedHalvesAreNotRead) {
  Case c(200, 2);
  ASSERT_TRUE(c.has_rows(true) && c.has_rows(false));
  for (const Region& region : c.residual.regions) {
    const std::size_t row_words = (region.coordinate_count + 1) / 2;
    for (std::size_t k = 0; region.coordinate_count % 2 == 1 && k < region.centre_count; ++k) {
      std::uint32_t& last = c.residual.centres[region.centre_values + (k + 1) * row_words - 1];
      ASSERT_EQ(last >> 16, 0u);
      last |= half_from_float(-1.5f) << 16;
    }
  }
  std::vector<float> kernels(c.kernels.size());
  cpu::residual_kernels(c.residual, c.coordinates, c.frames, kernels);
  EXPECT_EQ(kernels, c.kernels);
  KernelSet set(*device_);
  expect_reference(*device_, "residual_kernels", c.on(set));
}

TEST_F(ResidualKernels, ReferenceEqualsTheTextbook) {
  const Case c(100, 2);
  for (std::uint32_t f = 0; f < c.frames; ++f) {
    std::size_t m = 0;
    for (const Region& region : c.residual.regions) {
      for (std::size_t k = 0; k < region.centre_count; ++k, ++m) {
        double distance2 = 0;
        for (std::size_t i = 0; i < region.coordinate_count; ++i) {
          const double coordinate =
              c.coordinates[std::size_t{c.residual.coordinate_count()} * f + region.coordinate_begin + i];
          distance2 += std::pow(coordinate - double{centre_value(c.residual, region, k, i)}, 2);
        }
        ASSERT_NEAR(c.kernels[100 * f + m], std::exp(-distance2 * region.inverse_width2), 1e-6);
      }
    }
    ASSERT_EQ(m, 100u);
  }
}

}  // namespace residual_kernels_test
}  // namespace bodyopt::testing
