// Regions by skin weights.
#include <gtest/gtest.h>

#include "assets/characters/joints_with_skin.h"
#include "tests/support/capsule_limb.h"

namespace bodyopt {
namespace {

TEST(JointRegions, AreTheSkinWeightsOfJointsThatHaveSkin) {
  const Character limb = limb_character();
  const std::vector<RegionWeights> regions = joint_regions(limb);
  ASSERT_EQ(regions.size(), 3u);
  EXPECT_EQ(regions[1].name, "joint1");
  const Eigen::VectorXd sums = sum_of_weights(regions, limb.vertices.rows());
  EXPECT_LT((sums.array() - 1).abs().maxCoeff(), 1e-12);
  for (std::size_t k = 0; k < regions[1].vertices.size(); ++k) {
    const std::vector<JointWeight> expected = limb_weights(limb.vertices(regions[1].vertices[k], 2));
    const auto own = std::find_if(expected.begin(), expected.end(), [](const JointWeight& w) { return w.joint == 1; });
    ASSERT_NE(own, expected.end());
    EXPECT_NEAR(regions[1].weights[k], own->weight, kNegligibleRegionWeight);
  }
}

TEST(JointRegions, SmallPartsGoToTheJointAbove) {
  Character limb = limb_character();
  for (auto& weights : limb.weights) {
    if (weights.front().joint == 2) weights = {{1, 1}};
  }
  limb.weights.front() = {{2, 1}};
  const std::vector<RegionWeights> regions = joint_regions(limb);
  ASSERT_EQ(regions.size(), 2u);
  EXPECT_EQ(regions[1].name, "joint1");
  EXPECT_EQ(regions[1].vertices.front(), 0u);
}

}  // namespace
}  // namespace bodyopt
