#include "trainer/check/foresee.h"

#include <gtest/gtest.h>

#include "tests/simulate/limb.h"
#include "trainer/simulate/simulate.h"

namespace bodyopt {
namespace {

std::vector<BodyFill> fills(const CharacterForesight& foresight) {
  std::vector<BodyFill> result;
  for (const VerbForesight& verb : foresight.verbs) result.push_back(verb.fill);
  return result;
}

TEST(Foresee, ASoundSkinIsFilledAsItIs) {
  const CharacterForesight foresight = foresee(make_limb());
  EXPECT_EQ(fills(foresight), (std::vector(3, BodyFill::skin)));
  EXPECT_TRUE(foresight.verbs[0].has_contact);
  EXPECT_TRUE(foresight.intersections.empty());
  EXPECT_TRUE(foresight.near_parts.empty());
  EXPECT_TRUE(foresight.remarks.empty());
}

TEST(Foresee, SheetsGoIntoALatticeAndHaveNoDynamics) {
  Character sheet = make_limb();
  sheet.triangles = sheet.triangles.topRows(sheet.triangles.rows() / 2).eval();
  const CharacterForesight foresight = foresee(sheet);
  EXPECT_EQ(fills(foresight), (std::vector{BodyFill::lattice, BodyFill::lattice, BodyFill::refused}));
  EXPECT_FALSE(foresight.verbs[0].has_contact);
  for (const VerbForesight& verb : foresight.verbs) {
    EXPECT_NE(verb.why.find("boundary edges"), std::string::npos) << verb.why;
    EXPECT_FALSE(verb.remedy.empty());
  }
}

// A vertex pulled through the upper limb: found at its joint, mended by all verbs.
TEST(Foresee, IntersectionsAreListedByJoint) {
  Character limb = make_limb();
  const Eigen::Index spike = 5 * kTubeSides;
  limb.vertices.row(spike).tail(2) *= -1.3;
  const CharacterForesight foresight = foresee(limb);
  ASSERT_FALSE(foresight.intersections.empty());
  EXPECT_EQ(foresight.intersections.front().joint, "upper");
  EXPECT_EQ(fills(foresight), (std::vector(3, BodyFill::mended)));
}

// Two limbs a hair apart that hang on different joints.
TEST(Foresee, NearPartsAreNamedByTheirJoints) {
  Character both = make_two_limbs(2 * kTubeRadius + 0.002);
  for (std::size_t v = 0; v < both.weights.size(); ++v)
    both.weights[v] = {{2 * v < both.weights.size() ? 0u : 1u, 1.0}};
  const CharacterForesight foresight = foresee(both);
  ASSERT_EQ(foresight.near_parts.size(), 1u);
  EXPECT_EQ(foresight.near_parts[0].joint, "upper");
  EXPECT_EQ(foresight.near_parts[0].other, "lower");
}

TEST(Foresee, OddSizesAndIdleJointsAreRemarkedOn) {
  Character limb = make_limb();
  limb.vertices *= 20;
  for (Joint& joint : limb.skeleton.joints) {
    for (double& x : joint.bind.translation) x *= 20;
    joint.inverse_bind.m[0][3] *= 20;
  }
  Joint idle = limb.skeleton.joints[1];
  idle.name = "helper";
  idle.parent = 1;
  limb.skeleton.joints.push_back(idle);
  const CharacterForesight foresight = foresee(limb);
  ASSERT_EQ(foresight.remarks.size(), 2u);
  EXPECT_NE(foresight.remarks[0].find("--unit 0.2"), std::string::npos) << foresight.remarks[0];
  EXPECT_NE(foresight.remarks[1].find("'helper'"), std::string::npos) << foresight.remarks[1];
}

}  // namespace
}  // namespace bodyopt
