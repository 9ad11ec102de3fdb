#include <gtest/gtest.h>

#include <cmath>

#include "runtime/coverage/expected_error.h"
#include "runtime/cpu/kernels.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/trained_basis.h"
#include "trainer/train/fit/train.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt {
namespace {

class RegionSharesTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { basis_ = trained_basis(limb_samples(160, 0), {.centres = 60}); }

  static inline Basis basis_;
  const std::size_t regions_ = basis_.coverage.sizes.size();
  const RegionShares shares_{basis_};
};

TEST_F(RegionSharesTest, WhatAllRegionsShareIsThatOfEveryVertexThatLearnedSomething) {
  const std::vector<float> metres = shares_.carry(std::vector<double>(regions_, 2));
  ASSERT_EQ(metres.size(), basis_.mesh.vertex_count());
  std::vector<float> coefficients(basis_.residual.coefficient_count()), displacements(3 * metres.size());
  for (std::size_t k = 0; k < coefficients.size(); ++k) coefficients[k] = 1 + std::sin(static_cast<float>(k));
  cpu::residual_blend(basis_.residual, coefficients, 1, 1, displacements);
  std::size_t learned = 0;
  for (std::size_t v = 0; v < metres.size(); ++v) {
    const bool moves = displacements[3 * v] != 0 || displacements[3 * v + 1] != 0 || displacements[3 * v + 2] != 0;
    EXPECT_NEAR(metres[v], moves ? 0.002 : 0, 1e-8) << v;
    learned += moves;
  }
  EXPECT_GT(learned, metres.size() / 2);
}

// The weights that training gave a region are not kept; the number of vertices that they come to is.
TEST_F(RegionSharesTest, AreAboutTheWeightsOfTraining) {
  ASSERT_GT(regions_, 2u);
  for (std::size_t r = 0; r < regions_; ++r) {
    std::vector<double> one(regions_);
    one[r] = 1e3;
    double vertices = 0;
    for (const float x : shares_.carry(one)) vertices += static_cast<double>(x) * static_cast<double>(x);
    const double size{basis_.coverage.sizes[r]};
    EXPECT_NEAR(vertices, size, 0.4 * size) << basis_.coverage.names[r];
  }
}

TEST_F(RegionSharesTest, WithoutRegionsNothingIsExpected) {
  const Basis plain = build_ddm_basis(limb_character(), {});
  for (const float x : RegionShares(plain).carry({})) EXPECT_EQ(x, 0);
}

}  // namespace
}  // namespace bodyopt
