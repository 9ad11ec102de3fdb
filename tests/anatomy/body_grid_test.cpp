// Samples inside a skin: as much as it encloses, as deep as they are, whatever is wrong with it.
#include "trainer/anatomy/body_grid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/mend_surface.h"
#include "runtime/core/error.h"
#include "tests/anatomy/egg_human.h"
#include "tests/support/error_kind.h"

namespace {

using namespace bodyopt;
using namespace bodyopt::trainer;

const HalfBody& human_half() {
  static const HalfBody half = halves_of(egg_human()).front();
  return half;
}

const BodyGrid& human_grid() {
  static const BodyGrid grid = sample_body(human_half(), 0.012);
  return grid;
}

TEST(BodyGrid, HoldsTheVolumeThatTheSkinEncloses) {
  const double enclosed = enclosed_volume(human_half().vertices, human_half().triangles);
  EXPECT_NEAR(2 * human_grid().size() * human_grid().volume(), enclosed, 0.02 * enclosed);
  EXPECT_TRUE(human_grid().notes.empty());
  EXPECT_EQ(human_grid().low.x(), 0) << "the median plane lies between cells";
}

TEST(BodyGrid, KnowsItsSamplesByPlaceAndTheirDepth) {
  const BodyGrid& grid = human_grid();
  for (int s = 0; s < grid.size(); s += 97) {
    const Eigen::Vector3d point = grid.points.row(s);
    ASSERT_EQ(grid.sample_at(point), s);
    const SkinPoint& skin = grid.skin[static_cast<std::size_t>(s)];
    ASSERT_NEAR((skin.position - point).norm(), grid.depth[s], 1e-12);
    ASSERT_NEAR(grid.on_skin(human_half().vertices.col(1), s), skin.position.y(), 1e-9);
  }
  EXPECT_EQ(grid.sample_at(Eigen::Vector3d(-1, 0, 0)), -1);
  EXPECT_EQ(grid.sample_at(Eigen::Vector3d(1e9, NAN, 0)), -1);
}

TEST(BodyGrid, SkinInsideOutHoldsTheSame) {
  HalfBody half = human_half();
  half.triangles.col(1).swap(half.triangles.col(2));
  EXPECT_EQ(sample_body(half, 0.012).cells.size(), human_grid().cells.size());
}

TEST(BodyGrid, HoleIsToldAndLosesLittle) {
  HalfBody half = human_half();
  std::vector<Eigen::Index> kept;  // without twenty in front of the belly
  for (Eigen::Index t = 0; t < half.triangles.rows(); ++t) {
    if (t < 270 || t >= 290) kept.push_back(t);
  }
  half.triangles = Triangles(half.triangles(kept, Eigen::all));
  const BodyGrid grid = sample_body(half, 0.012);
  EXPECT_EQ(grid.notes.size(), 1u);
  EXPECT_NEAR(grid.size(), human_grid().size(), 0.01 * human_grid().size());
}

TEST(BodyGrid, SkinThroughSkinHoldsWhatEitherHolds) {
  HalfBody half = human_half();  // and the same again, beside it, through it
  const Eigen::Index rows = half.vertices.rows(), triangles = half.triangles.rows();
  half.vertices.conservativeResize(2 * rows, 3);
  half.vertices.bottomRows(rows) = half.vertices.topRows(rows);
  half.vertices.bottomRows(rows).col(1).array() += 0.05;
  half.triangles.conservativeResize(2 * triangles, 3);
  half.triangles.bottomRows(triangles) = half.triangles.topRows(triangles).array() + static_cast<unsigned>(rows);
  const BodyGrid grid = sample_body(half, 0.012);
  EXPECT_TRUE(grid.notes.empty());
  EXPECT_GT(grid.size(), human_grid().size());
  EXPECT_LT(grid.size(), 1.3 * human_grid().size());
}

TEST(BodyGrid, SheetEnclosesNothing) {
  HalfBody half = human_half();
  half.triangles = Triangles(half.triangles.topRows(1));
  EXPECT_EQ(bodyopt::testing::kind_of([&] { sample_body(half, 0.012); }), ErrorKind::mismatch);
}

TEST(BodyGrid, CellsFollowTheVolume) {
  Character human = egg_human();
  const double cell = default_cell(human);
  EXPECT_NEAR(cell, 0.0075, 1e-4);  // 205 l
  human.vertices *= 100;
  EXPECT_NEAR(default_cell(human), 100 * cell, 1e-9);
}

// Both halves of an open body say the same of it.
TEST(BodyGrid, OpenSkinIsToldInWordsThatDoNotDependOnTheHalf) {
  Character human = egg_human();
  human.triangles = Triangles(human.triangles.bottomRows(human.triangles.rows() - 60));
  const std::vector<HalfBody> halves = halves_of(human);
  ASSERT_EQ(halves.size(), 2u);
  const BodyGrid left = sample_body(halves[0], 0.012), right = sample_body(halves[1], 0.012);
  EXPECT_EQ(left.notes.size(), 1u);
  EXPECT_EQ(left.notes, right.notes);
}

}  // namespace
