#include "trainer/check/foresee.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "assets/character.h"
#include "runtime/core/error.h"
#include "tests/simulate/limb.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/shared_data.h"
#include "trainer/proxy/build_proxy.h"
#include "trainer/simulate/simulate.h"
#include "trainer/train/fit/train.h"

namespace bodyopt {
namespace {

// Of simulate, its draft and dynamics.
std::vector<BodyFill> fills(const CharacterForesight& foresight) {
  std::vector<BodyFill> result;
  for (std::size_t v = 0; v < 3; ++v) result.push_back(foresight.verbs.at(v).fill);
  return result;
}

BodyFill of_verb(const std::vector<VerbForesight>& verbs, const std::string& name) {
  return std::find_if(verbs.begin(), verbs.end(), [&](const VerbForesight& v) { return v.verb == name; })->fill;
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
  for (std::size_t v = 0; v < 3; ++v) {
    EXPECT_NE(foresight.verbs[v].why.find("boundary edges"), std::string::npos) << foresight.verbs[v].why;
    EXPECT_FALSE(foresight.verbs[v].remedy.empty());
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

// A body whose own skin is filled is not asked to be mended where a coarser skin cannot be; what the lattice holds
// together is named by place: the neck, under the chin.
TEST(Foresee, ADraftThatIsALatticeIsToldOfTheFullSimulation) {
  const auto file = shared_data("characters/human_average.glb");
  if (!file) GTEST_SKIP() << kNeedsRealBodies;
  const CharacterForesight foresight = foresee(read_character(*file));
  ASSERT_EQ(foresight.verbs[0].fill, BodyFill::skin);
  ASSERT_EQ(foresight.verbs[1].fill, BodyFill::lattice);
  EXPECT_NE(foresight.verbs[1].why.find("passes through itself at"), std::string::npos) << foresight.verbs[1].why;
  EXPECT_NE(foresight.verbs[1].remedy.find("leave out --draft"), std::string::npos) << foresight.verbs[1].remedy;
  ASSERT_FALSE(foresight.glued.empty());
  const RestPlace& neck = foresight.glued.front();
  EXPECT_EQ(neck.joint + " " + neck.other, "Neck Head");
  EXPECT_EQ(std::set(neck.vertices.begin(), neck.vertices.end()).size(), neck.vertices.size());
  EXPECT_NEAR(neck.position[1], 0.65, 0.05);
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

// A joint that no pose turns teaches nothing; the root may rest.
TEST(Foresee, JointsThatNoClipTurnsAreRemarkedOn) {
  const Character limb = make_limb();
  const std::vector<Pose> still(3, bind_pose(limb.skeleton));
  std::vector<Pose> bent = still;
  bent[1].joints[1].rotation = {0, 0, 0.3f, 0.954f};
  EXPECT_TRUE(foresee(limb, bent).remarks.empty());
  const std::vector<std::string> remarks = foresee(limb, still).remarks;
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_NE(remarks[0].find("'lower'"), std::string::npos) << remarks[0];
}

// Of a large character it takes minutes.
TEST(Foresee, TellsHowFarItIs) {
  ::testing::internal::CaptureStderr();
  foresee(make_limb());
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("check: 100 % (7/7"), std::string::npos) << said;
}

// What is foreseen of a dataset is what train and proxy then do.
TEST(Foresee, WhatTrainAndProxyDo) {
  SampleSet set = limb_samples(20, 4);
  EXPECT_EQ(of_verb(foresee_training(set), "train"), BodyFill::works);
  EXPECT_NO_THROW(train(set, {.components = 4, .centres = 8}));
  std::vector<std::string> notes;
  EXPECT_EQ(of_verb(foresee_training(set), "proxy"), BodyFill::works);
  EXPECT_NO_THROW(build_proxy(set, {.errors = {}, .train = {.components = 4, .centres = 8}}, notes));

  set.train.resize(5);
  for (const VerbForesight& verb : foresee_training(set)) {
    EXPECT_EQ(verb.fill, BodyFill::refused) << verb.verb;
    EXPECT_NE(verb.why.find("frames at least"), std::string::npos) << verb.why;
    EXPECT_FALSE(verb.remedy.empty()) << verb.verb;
  }
  EXPECT_THROW(build_proxy(set, {}, notes), Error);
}

}  // namespace
}  // namespace bodyopt
