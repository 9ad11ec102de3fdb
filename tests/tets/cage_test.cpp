#include "trainer/tets/cage.h"

#include <gtest/gtest.h>

#include "tests/builtin/shared_arm.h"
#include "tests/simulate/limb.h"
#include "tests/support/error_kind.h"
#include "tests/support/lowered_limit.h"

namespace bodyopt::trainer {
namespace {

TEST(MakeCage, TakesTheSkinWhereItCanBeFilled) {
  const Character& character = arm().character;
  EXPECT_FALSE(make_cage(character.vertices, character.triangles, character.weights, {1500, 0, 0, 1500}).is_lattice);
  const Triangles open = character.triangles.topRows(character.triangles.rows() / 2);
  const Cage lattice = make_cage(character.vertices, open, character.weights, {1500, 0, 0, 1500});
  EXPECT_TRUE(lattice.is_lattice);
  ASSERT_TRUE(lattice.why_lattice);
  EXPECT_EQ(lattice.why_lattice->cause(), ErrorCause::open_edges) << lattice.why_lattice->what();
  // So coarse a skin leaves too much outside.
  const Cage coarse = make_cage(character.vertices, character.triangles, character.weights, {120, 0, 0, 120});
  EXPECT_TRUE(coarse.is_lattice);
  EXPECT_TRUE(coarse.why_lattice);
}

// Before the skin itself, and that before a lattice.
TEST(MakeCage, TakesAFinerSkinWhereNoneComesOutSoCoarse) {
  const Character& character = arm().character;
  const Cage finer = make_cage(character.vertices, character.triangles, character.weights, {120, 1500, 0, 120});
  EXPECT_FALSE(finer.is_lattice || finer.is_own_skin);
  EXPECT_GT(finer.mesh.nodes.rows(), 120);
  const Character limb = make_two_limbs(0.1);
  EXPECT_TRUE(make_cage(limb.vertices, limb.triangles, limb.weights, {100, 0, 2000, 100}).is_own_skin);
  EXPECT_TRUE(make_cage(limb.vertices, limb.triangles, limb.weights, {100, 0, 300, 100}).is_lattice);
}

// No word of the skin: a lattice in its place would be another body.
TEST(MakeCage, WhatIsNotForTheSkinIsNoReasonForALattice) {
  const Character limb = make_limb();
  const auto cage = [&] { return make_cage(limb.vertices, limb.triangles, limb.weights, {500, 0, 0, 500}); };
  EXPECT_FALSE(cage().is_lattice);
  const LoweredLimit limit(RLIMIT_NOFILE, 3);
  EXPECT_EQ(testing::kind_of(cage), ErrorKind::device);
}

// A lattice of pieces in one cell is joined; filled, they would drift apart.
TEST(MakeCage, PiecesOfSkinGoIntoOneLattice) {
  const Character both = make_two_limbs(0.1);
  const Cage cage = make_cage(both.vertices, both.triangles, both.weights, {500, 0, 0, 500});
  EXPECT_TRUE(cage.is_lattice);
  ASSERT_TRUE(cage.why_lattice);
  EXPECT_EQ(cage.why_lattice->cause(), ErrorCause::several_pieces);
  EXPECT_NE(std::string(cage.why_lattice->what()).find("2 pieces"), std::string::npos) << cage.why_lattice->what();
}

}  // namespace
}  // namespace bodyopt::trainer
