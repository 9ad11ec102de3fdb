// Joints above all of the skin, and joints above some of it.
#include "assets/characters/joints_with_skin.h"

#include <gtest/gtest.h>

#include "tests/support/capsule_limb.h"

namespace bodyopt {
namespace {

TEST(JointsWithSkin, AreCountedAtAndBelowEveryJoint) {
  EXPECT_EQ(joints_with_skin(limb_character()), (std::vector<int>{3, 2, 1}));
  EXPECT_EQ(joints_of_all_skin(limb_character()), (std::vector<bool>{true, false, false}));
}

TEST(JointsWithSkin, ATraceIsNoSkin) {
  Character limb = limb_character();
  for (auto& weights : limb.weights) weights = {{1, 0.97}, {0, 0.03}};
  EXPECT_EQ(joints_with_skin(limb), (std::vector<int>{1, 1, 0}));
  EXPECT_EQ(joints_of_all_skin(limb), (std::vector<bool>{true, true, false}));
}

// Of two roots neither is above all of the skin, although one is above more than any other joint.
TEST(JointsWithSkin, OfTwoTreesNoneIsAboveAll) {
  Character limb = limb_character();
  limb.skeleton.joints[2].parent = -1;
  EXPECT_EQ(joints_with_skin(limb), (std::vector<int>{2, 1, 1}));
  EXPECT_EQ(joints_of_all_skin(limb), (std::vector<bool>{false, false, false}));
}

TEST(JointsWithSkin, ThoseThatBendAreNeitherRootsNorAboveAll) {
  Character limb = limb_character();
  EXPECT_EQ(joints_that_bend(limb), (std::vector<std::uint32_t>{1, 2}));
  for (std::size_t v = 0; v < limb.weights.size(); ++v) limb.weights[v] = {{v % 2 == 0 ? 1u : 2u, 1.0}};
  EXPECT_EQ(joints_that_bend(limb), (std::vector<std::uint32_t>{2}));
}

}  // namespace
}  // namespace bodyopt
