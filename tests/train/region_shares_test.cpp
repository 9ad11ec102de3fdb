#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "runtime/coverage/expected_error.h"
#include "runtime/cpu/kernels.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/trained_basis.h"
#include "trainer/train/fit/train.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::trainer {
namespace {

class RegionSharesTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { basis_ = trained_basis(limb_samples(160, 0), {.centres = 60}); }

  static inline Basis basis_;
  const std::size_t regions_ = basis_.coverage.sizes.size();
  const RegionShares shares_{basis_};
};

// Of one region, the sum of squares over its vertices is that of its error over as many as its size, and each vertex
// has of it what the region's coefficients, one after the other, move of the vertex.
TEST_F(RegionSharesTest, SpreadTheErrorOfARegionAsItsComponentsMoveTheSkin) {
  ASSERT_GT(regions_, 2u);
  const std::size_t coefficients = basis_.residual.coefficient_count();
  for (std::size_t r = 0; r < regions_; ++r) {
    std::vector<double> one(regions_), moved(basis_.mesh.vertex_count());
    one[r] = 2;
    for (std::size_t k = 0; k < coefficients; ++k) {
      if (basis_.residual.coefficient_region[k] != r) continue;
      std::vector<float> unit(coefficients), displacements(3 * moved.size());
      unit[k] = 1;
      cpu::residual_blend(basis_.residual, unit, 1, 1, displacements);
      for (std::size_t i = 0; i < displacements.size(); ++i) moved[i / 3] += std::pow(double{displacements[i]}, 2);
    }
    const double all = std::accumulate(moved.begin(), moved.end(), 0.0), size{basis_.coverage.sizes[r]};
    const double most = *std::max_element(moved.begin(), moved.end());
    const std::vector<float> metres = shares_.carry(one);
    double squares = 0;
    for (std::size_t v = 0; v < metres.size(); ++v) {
      squares += std::pow(double{metres[v]}, 2);
      EXPECT_EQ(metres[v] > 0, moved[v] > 0) << v;
      const double expected = 0.002 * std::sqrt(size * moved[v] / all);
      const double loose = moved[v] > 0.01 * most ? 0.02 : 1;  // roundings count where little moves
      EXPECT_NEAR(double{metres[v]}, expected, loose * expected) << v;
    }
    EXPECT_NEAR(squares, size * 4e-6, 1e-5 * size * 4e-6) << basis_.coverage.names[r];
  }
}

TEST_F(RegionSharesTest, WithoutRegionsNothingIsExpected) {
  const Basis plain = build_ddm_basis(limb_character(), {});
  for (const float x : RegionShares(plain).carry({})) EXPECT_EQ(x, 0);
}

}  // namespace
}  // namespace bodyopt::trainer
