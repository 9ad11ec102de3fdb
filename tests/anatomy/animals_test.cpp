// Bone, fat and cavity of bodies that are no humans: how much of each there is, and where none may be.
#include <gtest/gtest.h>

#include <map>

#include "tests/anatomy/tube_body.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/error_kind.h"
#include "tests/support/shared_data.h"
#include "trainer/anatomy/body_survey.h"

namespace {

using namespace bodyopt;
using namespace bodyopt::trainer;

// Shares of volume, and of each region's that is cavity.
struct Shares {
  double bone = 0, fat = 0, cavity = 0;
  std::map<BodyRegion, double> cavity_in;
  std::vector<std::string> notes;
};

Shares shares_of(const Character& character, InnerTissueOptions options = {}) {
  Shares shares;
  double all = 0;
  std::map<BodyRegion, double> regions;
  options.kind = recognise_kind(character).kind;
  for (const HalfBody& half : halves_of(character, options.kind)) {
    const BodyGrid grid = sample_body(half, 1.5 * default_cell(character));
    const InnerTissue tissue = find_inner_tissue(half, grid, options);
    shares.notes.insert(shares.notes.end(), tissue.notes.begin(), tissue.notes.end());
    for (int s = 0; s < grid.size(); ++s, ++all) {
      const TissueKind kind = tissue.kind(s);
      shares.bone += kind == TissueKind::bone ? 1 : 0;
      shares.fat += kind == TissueKind::fat ? 1 : 0;
      shares.cavity += kind == TissueKind::cavity ? 1 : 0;
      const BodyRegion region = tissue.region[static_cast<std::size_t>(s)];
      ++regions[region];
      shares.cavity_in[region] += kind == TissueKind::cavity ? 1 : 0;
    }
  }
  for (double* share : {&shares.bone, &shares.fat, &shares.cavity}) *share /= all;
  for (auto& [region, cavity] : shares.cavity_in) cavity /= regions[region];
  return shares;
}

void expect_cavity_in_trunk_alone(const Shares& shares, const std::string& name) {
  EXPECT_GT(shares.cavity_in.at(BodyRegion::trunk), 0.05) << name;
  for (const auto& [region, cavity] : shares.cavity_in) {
    EXPECT_TRUE(is_trunk(region) || cavity == 0) << name << ", " << name_of(region) << ": " << cavity;
  }
}

void expect_sound(const Character& character, const std::string& name) {
  const Shares shares = shares_of(character);
  EXPECT_GT(shares.bone, 0.06) << name;
  EXPECT_LT(shares.bone, 0.14) << name;
  EXPECT_GT(shares.fat, 0.05) << name;
  EXPECT_LT(shares.fat, 0.2) << name;
  expect_cavity_in_trunk_alone(shares, name);
}

TEST(Animals, OfTubesHaveASkeletonAndNoCavityInLimbs) {
  expect_sound(snake_body(), "snake");
  expect_sound(fish_body(), "fish");
  expect_sound(winged_or_four_legged(true), "bird");
  expect_sound(winged_or_four_legged(false), "quadruped");
  EXPECT_GT(shares_of(snake_body()).cavity, 0.1);
  EXPECT_GT(shares_of(winged_or_four_legged(false)).cavity, 0.1);
}

TEST(Animals, ThatOthersMade) {
  const std::vector<std::pair<std::string, double>> characters{{"fox.glb", 0.01},
                                                               {"mesh2motion_horse.glb", 1},
                                                               {"quaternius_horse.glb", 0.3},
                                                               {"quaternius_trex.glb", 0.4},
                                                               {"cesium_man.glb", 1}};
  for (const auto& [file, unit] : characters) {
    const auto path = shared_data("characters/" + file);
    if (!path) GTEST_SKIP() << kNeedsOtherWriters;
    expect_sound(read_character(*path, unit), file);
  }
  // Its few joints leave it too few bones.
  expect_cavity_in_trunk_alone(shares_of(read_character(*shared_data("characters/greenman.glb"), 1)), "greenman");
}

// The cavity of a horse ends before its hips, and leaves its shoulders to muscle.
TEST(Animals, CavityOfAHorseLiesBetweenShouldersAndHips) {
  const auto path = shared_data("characters/mesh2motion_horse.glb");
  if (!path) GTEST_SKIP() << kNeedsOtherWriters;
  const Character horse = read_character(*path, 1);
  const HalfBody half = halves_of(horse, BodyKind::quadruped).front();
  const BodyGrid grid = sample_body(half, 1.5 * default_cell(horse));
  InnerTissueOptions options;
  options.kind = BodyKind::quadruped;
  const InnerTissue tissue = find_inner_tissue(half, grid, options);
  const double hip = half.places[static_cast<std::size_t>(horse.skeleton.find("back_leg_upper_l"))].z();
  const double shoulder = half.places[static_cast<std::size_t>(horse.skeleton.find("front_humerus_l"))].z();
  int inside = 0;
  for (int s = 0; s < grid.size(); ++s) {
    if (tissue.kind(s) != TissueKind::cavity) continue;
    ++inside;
    EXPECT_GT(grid.points(s, 2), hip);
    EXPECT_LT(grid.points(s, 2), shoulder + 0.05);
  }
  EXPECT_GT(inside, 0.15 * grid.size());
}

TEST(Animals, SayWhatCouldNotBePlaced) {
  TubeBody single;
  const int joint = single.joint("b0", -1, {0, 0.1, 0});
  single.tube({{{0, 0, 0}, 0.1, 0.1, joint}, {{0, 0.4, 0}, 0.1, 0.1, joint}});
  const Shares shares = shares_of(single.character());
  EXPECT_GT(shares.fat, 0);
  EXPECT_EQ(shares.cavity, 0);

  Character open = winged_or_four_legged(false);
  open.triangles = Triangles(open.triangles.bottomRows(open.triangles.rows() - 60));  // without the tail's skin
  EXPECT_FALSE(shares_of(open).notes.empty());

  Character sheet = limb_character();
  sheet.triangles.conservativeResize(2, 3);
  EXPECT_EQ(bodyopt::testing::kind_of([&] { shares_of(sheet); }), ErrorKind::mismatch);
}

TEST(Animals, FollowAnArtistsCorrections) {
  const Character horse = winged_or_four_legged(false);
  const Shares found = shares_of(horse);
  InnerTissueOptions options;
  options.corrections.bones["h0"].carries = false;
  EXPECT_LT(shares_of(horse, options).bone, found.bone);
  options = {};
  options.corrections.bones["b0"].thicker = 0.01;
  EXPECT_GT(shares_of(horse, options).bone, found.bone);
}

}  // namespace
