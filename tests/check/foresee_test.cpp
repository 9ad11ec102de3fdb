#include "trainer/check/foresee.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "assets/characters/character.h"
#include "runtime/core/error.h"
#include "tests/simulate/limb.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/shared_data.h"
#include "trainer/proxy/build_proxy.h"
#include "trainer/simulate/simulate.h"
#include "trainer/train/fit/train.h"

namespace bodyopt::trainer {
namespace {

// Of simulate, its draft and dynamics.
std::vector<BodyFill> fills(const CharacterForecast& forecast) {
  std::vector<BodyFill> result;
  for (std::size_t v = 0; v < 3; ++v) result.push_back(forecast.verbs.at(v).fill);
  return result;
}

BodyFill of_verb(const std::vector<VerbForecast>& verbs, const std::string& name) {
  return std::find_if(verbs.begin(), verbs.end(), [&](const VerbForecast& v) { return v.verb == name; })->fill;
}

std::vector<ErrorCause> causes(const std::vector<VerbForecast>& verbs) {
  std::vector<ErrorCause> all;
  for (const VerbForecast& verb : verbs) all.push_back(verb.cause);
  return all;
}

TEST(Foresee, ASoundSkinIsFilledAsItIs) {
  const CharacterForecast forecast = foresee(make_limb());
  EXPECT_EQ(fills(forecast), (std::vector(3, BodyFill::skin)));
  EXPECT_TRUE(forecast.verbs[0].why.empty() && forecast.verbs[0].remedy.empty());
  EXPECT_TRUE(forecast.verbs[0].has_contact);
  EXPECT_TRUE(forecast.intersections.empty());
  EXPECT_TRUE(forecast.near_parts.empty());
  EXPECT_TRUE(forecast.remarks.empty());
}

TEST(Foresee, SheetsGoIntoALatticeAndHaveNoDynamics) {
  Character sheet = make_limb();
  sheet.triangles = sheet.triangles.topRows(sheet.triangles.rows() / 2).eval();
  const CharacterForecast forecast = foresee(sheet);
  EXPECT_EQ(fills(forecast), (std::vector{BodyFill::lattice, BodyFill::lattice, BodyFill::refused}));
  EXPECT_TRUE(forecast.verbs[0].has_contact);
  for (std::size_t v = 0; v < 3; ++v) {
    EXPECT_EQ(forecast.verbs[v].cause, ErrorCause::open_edges) << forecast.verbs[v].why;
    EXPECT_FALSE(forecast.verbs[v].remedy.empty());
  }
}

// Each cause has its own remedy, and a place where one sees it.
TEST(Foresee, HolesAndFlatSkinsHaveTheirOwnRemedies) {
  Character sheet = make_limb();
  sheet.triangles = sheet.triangles.topRows(sheet.triangles.rows() / 2).eval();
  const CharacterForecast open = foresee(sheet);
  EXPECT_EQ(open.verbs[2].cause, ErrorCause::open_edges) << open.verbs[2].why;
  ASSERT_FALSE(open.holes.empty());
  EXPECT_TRUE(open.flipped.empty());

  Character flat = make_limb();
  flat.vertices.col(2).setZero();
  const CharacterForecast thin = foresee(flat);
  EXPECT_TRUE(thin.holes.empty());
  EXPECT_EQ(thin.verbs[2].cause, ErrorCause::flat) << thin.verbs[2].why;
  EXPECT_NE(thin.verbs[2].remedy, open.verbs[2].remedy);
}

TEST(Foresee, FlippedFacesAndHolesAreListedByJoint) {
  Character limb = make_limb();
  std::swap(limb.triangles(0, 1), limb.triangles(0, 2));
  const CharacterForecast turned = foresee(limb);
  ASSERT_EQ(turned.flipped.size(), 1u);
  EXPECT_EQ(turned.flipped[0].joint, "upper");
  EXPECT_EQ(turned.flipped[0].vertices.size(), 3u);
  EXPECT_TRUE(turned.holes.empty());

  Character holed = make_limb();
  holed.triangles = holed.triangles.bottomRows(holed.triangles.rows() - 1).eval();
  const CharacterForecast with_hole = foresee(holed);
  ASSERT_EQ(with_hole.holes.size(), 1u);
  EXPECT_EQ(with_hole.holes[0].vertices.size(), 3u);
  EXPECT_TRUE(with_hole.flipped.empty());
  EXPECT_TRUE(foresee(make_limb()).holes.empty());
}

// A small limb inside the large one is carried by it.
TEST(Foresee, PiecesThatRideAreListedByJoint) {
  Character both = make_limb();
  const Eigen::Index vertices = both.vertices.rows(), triangles = both.triangles.rows();
  both.vertices.conservativeResize(2 * vertices, 3);
  both.vertices.bottomRows(vertices) = 0.2 * both.vertices.topRows(vertices);
  both.triangles.conservativeResize(2 * triangles, 3);
  both.triangles.bottomRows(triangles) =
      both.triangles.topRows(triangles).array() + static_cast<std::uint32_t>(vertices);
  const auto weights = both.weights;
  both.weights.insert(both.weights.end(), weights.begin(), weights.end());
  const CharacterForecast forecast = foresee(both);
  ASSERT_FALSE(forecast.loose_pieces.empty());
  std::size_t riding = 0;
  for (const RestPlace& place : forecast.loose_pieces) {
    riding += place.vertices.size();
    EXPECT_GE(place.vertices.front(), static_cast<std::uint32_t>(vertices));
  }
  EXPECT_EQ(riding, static_cast<std::size_t>(vertices));
}

// Not the body, with which it shares an edge.
TEST(Foresee, AFinThatSharesAnEdgeRidesAlone) {
  Character limb = make_limb();
  const auto tip = static_cast<std::uint32_t>(limb.vertices.rows());
  const std::uint32_t a = limb.triangles(40, 0), b = limb.triangles(40, 1);
  limb.vertices.conservativeResize(tip + 1, 3);
  const Eigen::RowVector3d middle = 0.5 * (limb.vertices.row(a) + limb.vertices.row(b));
  limb.vertices.row(tip) = middle + Eigen::RowVector3d(0, 1.5 * middle[1], 1.5 * middle[2]);
  limb.weights.push_back(limb.weights[a]);
  limb.triangles.conservativeResize(limb.triangles.rows() + 1, 3);
  limb.triangles.bottomRows(1) << a, b, tip;
  const CharacterForecast forecast = foresee(limb);
  ASSERT_EQ(forecast.loose_pieces.size(), 1u);
  EXPECT_EQ(forecast.loose_pieces.front().vertices, std::vector<std::uint32_t>{tip});
}

// A vertex pulled through the upper limb: found at its joint, mended by all verbs.
TEST(Foresee, IntersectionsAreListedByJoint) {
  Character limb = make_limb();
  const Eigen::Index spike = 5 * kTubeSides;
  limb.vertices.row(spike).tail(2) *= -1.3;
  const CharacterForecast forecast = foresee(limb);
  ASSERT_FALSE(forecast.intersections.empty());
  EXPECT_EQ(forecast.intersections.front().joint, "upper");
  EXPECT_EQ(fills(forecast), (std::vector(3, BodyFill::mended)));
  for (std::size_t v = 0; v < 3; ++v) EXPECT_FALSE(forecast.verbs[v].why.empty());
}

// A limb whose end lies back in its middle: no small move parts them, and the remedy says that a picture shows where.
TEST(Foresee, IntersectionsThatCannotBeMovedApartAreListed) {
  Character limb = make_limb();
  const double last = limb.vertices.col(0).maxCoeff(), fold = 0.6 * last;
  for (Eigen::Index v = 0; v < limb.vertices.rows(); ++v) {
    double& x = limb.vertices(v, 0);
    if (x <= fold) continue;
    x = 2 * fold - x;
    limb.vertices(v, 1) += 0.5 * kTubeRadius;
  }
  const CharacterForecast forecast = foresee(limb);
  ASSERT_EQ(forecast.verbs[0].cause, ErrorCause::crossing) << forecast.verbs[0].why;
  EXPECT_NE(forecast.verbs[0].remedy.find("--picture shows where"), std::string::npos);
  EXPECT_FALSE(forecast.intersections.empty());
}

// Tetrahedra on a sliver are flat: nothing passes through itself that a picture could show. A coarser skin has none.
TEST(Foresee, SliversAreNotSaidToBeInThePicture) {
  Character limb = make_limb();
  const auto sliver = limb.triangles.row(60);
  limb.vertices.row(sliver[0]) = 0.5 * (limb.vertices.row(sliver[1]) + limb.vertices.row(sliver[2]));
  const CharacterForecast forecast = foresee(limb);
  EXPECT_EQ(forecast.verbs[0].fill, BodyFill::coarser);
  EXPECT_TRUE(forecast.verbs[0].has_contact);
  EXPECT_TRUE(forecast.intersections.empty());
  for (const VerbForecast& verb : forecast.verbs) EXPECT_EQ(verb.remedy.find("--picture"), std::string::npos);
}

// Two limbs a hair apart that hang on different joints.
Character near_limbs() {
  Character both = make_two_limbs(2 * kTubeRadius + 0.002);
  for (std::size_t v = 0; v < both.weights.size(); ++v)
    both.weights[v] = {{2 * v < both.weights.size() ? 0u : 1u, 1.0}};
  return both;
}

// Every triangle cut into four.
Character finer(Character character) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto next = static_cast<std::uint32_t>(character.weights.size());
    const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), next);
    if (is_new) {
      character.vertices.conservativeResize(next + 1, 3);
      character.vertices.row(next) = (character.vertices.row(a) + character.vertices.row(b)) / 2;
      character.weights.push_back(character.weights[a]);
    }
    return at->second;
  };
  Triangles four(4 * character.triangles.rows(), 3);
  for (Eigen::Index t = 0; t < character.triangles.rows(); ++t) {
    const std::uint32_t a = character.triangles(t, 0), b = character.triangles(t, 1), c = character.triangles(t, 2);
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    four.middleRows(4 * t, 4) << a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca;
  }
  character.triangles = four;
  return character;
}

TEST(Foresee, NearPartsAreNamedByTheirJoints) {
  const CharacterForecast forecast = foresee(near_limbs());
  ASSERT_EQ(forecast.near_parts.size(), 1u);
  EXPECT_EQ(forecast.near_parts[0].joint, "upper");
  EXPECT_EQ(forecast.near_parts[0].other, "lower");
}

// A body whose own skin is filled is not asked to be mended where a draft is a lattice; what that holds together is
// named by place.
TEST(Foresee, ADraftThatIsALatticeIsToldOfTheFullSimulation) {
  const CharacterForecast forecast = foresee(finer(near_limbs()));  // a draft of its own tets would be too large
  ASSERT_EQ(forecast.verbs[0].fill, BodyFill::skin);
  ASSERT_EQ(forecast.verbs[1].fill, BodyFill::lattice);
  EXPECT_EQ(forecast.verbs[1].cause, ErrorCause::several_pieces) << forecast.verbs[1].why;
  EXPECT_NE(forecast.verbs[1].remedy.find("leave out --draft"), std::string::npos) << forecast.verbs[1].remedy;
  ASSERT_FALSE(forecast.glued.empty());
  const RestPlace& between = forecast.glued.front();
  EXPECT_EQ(std::set({between.joint, between.other}), (std::set<std::string>{"upper", "lower"}));
  EXPECT_EQ(std::set(between.vertices.begin(), between.vertices.end()).size(), between.vertices.size());
  EXPECT_NEAR(between.position[1], kTubeRadius, 0.02);
}

// Lips that a coarser skin would pass through do not cost the draft its joints, as a lattice would.
TEST(Foresee, ADraftOfABodyWithLipsIsFilled) {
  const auto file = shared_data("characters/human_average.glb");
  if (!file) GTEST_SKIP() << kNeedsRealBodies;
  const CharacterForecast forecast = foresee(read_character(*file));
  EXPECT_EQ(forecast.verbs[0].fill, BodyFill::coarser);
  EXPECT_EQ(forecast.verbs[1].fill, BodyFill::coarser) << forecast.verbs[1].why;
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
  const CharacterForecast forecast = foresee(limb);
  ASSERT_EQ(forecast.remarks.size(), 2u);
  EXPECT_NE(forecast.remarks[0].find("--unit 0.2"), std::string::npos) << forecast.remarks[0];
  EXPECT_NE(forecast.remarks[1].find("'helper'"), std::string::npos) << forecast.remarks[1];
  // Of a file whose unit was said: what it should be, and not what should be made of that.
  const CharacterForecast with_unit = foresee(limb, {}, 0.1);
  EXPECT_NE(with_unit.remarks[0].find("--unit 0.02"), std::string::npos) << with_unit.remarks[0];
}

Clip clip_of(std::vector<Pose> poses, const std::string& name = "walk") {
  Clip clip;
  clip.name = name;
  clip.poses = std::move(poses);
  return clip;
}

// As many frames as training needs, the last joint bent in one.
Clip bending(const Skeleton& skeleton, const std::string& name) {
  std::vector<Pose> poses(kFewestFrames, bind_pose(skeleton));
  poses[1].joints[1].rotation = {0, 0, 0.3f, 0.954f};
  return clip_of(poses, name);
}

// simulate refuses them, so nothing is filled, whatever the skin; one that does not scale can still be simulated.
TEST(Foresee, ClipsThatScaleAJointAreRefused) {
  const Character limb = make_limb();
  Clip scaled = bending(limb.skeleton, "stretch");
  scaled.poses[2].joints[1].scale = {1.2, 1, 1};
  const CharacterForecast alone = foresee(limb, {scaled});
  for (std::size_t v = 0; v < 2; ++v) {
    EXPECT_EQ(alone.verbs[v].fill, BodyFill::refused);
    EXPECT_FALSE(alone.verbs[v].has_contact);
    EXPECT_NE(alone.verbs[v].why.find("clip 'stretch': joint 'lower' is scaled by 1.2"), std::string::npos)
        << alone.verbs[v].why;
    EXPECT_EQ(alone.verbs[v].remedy, "remove the scale in clip 'stretch'");
  }
  EXPECT_EQ(alone.verbs[2].fill, BodyFill::skin);

  const CharacterForecast among = foresee(limb, {bending(limb.skeleton, "walk"), scaled});
  EXPECT_EQ(among.verbs[0].fill, BodyFill::skin);
  ASSERT_EQ(among.remarks.size(), 1u);
  EXPECT_NE(among.remarks[0].find("refuses the clip 'stretch'"), std::string::npos) << among.remarks[0];
}

TEST(Foresee, ClipsTooShortToTrainOnAreRemarkedOn) {
  const Character limb = make_limb();
  Clip clip = bending(limb.skeleton, "step");
  EXPECT_TRUE(foresee(limb, {clip}).remarks.empty());
  clip.poses.pop_back();
  const std::vector<std::string> remarks = foresee(limb, {clip}).remarks;
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_NE(remarks[0].find("11 frames, training needs 12"), std::string::npos) << remarks[0];
  EXPECT_NE(remarks[0].find("bodyopt rom"), std::string::npos) << remarks[0];
  clip.poses.resize(6);
  EXPECT_TRUE(foresee(limb, {clip, clip}).remarks.empty());
}

// A joint that no pose turns teaches nothing; the root may rest.
TEST(Foresee, JointsThatNoClipTurnsAreRemarkedOn) {
  const Character limb = make_limb();
  const std::vector<Pose> still(kFewestFrames, bind_pose(limb.skeleton));
  EXPECT_TRUE(foresee(limb, {bending(limb.skeleton, "walk")}).remarks.empty());
  const std::vector<std::string> remarks = foresee(limb, {clip_of(still)}).remarks;
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
  EXPECT_EQ(causes(foresee_training(set)), (std::vector(2, ErrorCause::too_few_frames)));
  EXPECT_THROW(build_proxy(set, {}, notes), Error);
}

// What is wrong decides the advice, and not which verb it keeps from working. Where no cause is known, there is none.
TEST(Foresee, TrainingIsAdvisedByTheCause) {
  const SampleSet sound = limb_samples(20, 4);
  SampleSet damaged = sound, unweighted = sound, few = sound, without_control = sound;
  damaged.train[3].pose.joints[0].translation[0] = std::nan("");
  unweighted.character.weights.assign(unweighted.character.weights.size(), {});
  few.train.resize(kFewestFrames - 1);
  without_control.controls.emplace_back("biceps");
  std::set<std::string> remedies;
  for (const auto& [set, cause] :
       {std::pair(&damaged, ErrorCause::damaged), std::pair(&few, ErrorCause::too_few_frames),
        std::pair(&unweighted, ErrorCause::unweighted)}) {
    const VerbForecast train = foresee_training(*set).front();
    EXPECT_EQ(train.cause, cause) << train.why;
    EXPECT_FALSE(train.remedy.empty()) << train.why;
    remedies.insert(train.remedy);
  }
  EXPECT_EQ(remedies.size(), 3u);
  const VerbForecast unknown = foresee_training(without_control).front();
  EXPECT_EQ(unknown.cause, ErrorCause::other) << unknown.why;
  EXPECT_EQ(unknown.remedy, "") << unknown.why;
}

// A proxy of a tube of few vertices.
TEST(Foresee, ASkinOfFewVerticesNeedsNoProxy) {
  const VerbForecast proxy = foresee(make_limb()).verbs.at(4);
  EXPECT_EQ(proxy.cause, ErrorCause::too_few_vertices) << proxy.why;
}

}  // namespace
}  // namespace bodyopt::trainer
