#include "trainer/tets/fillable_skin.h"

#include <gtest/gtest.h>

#include "geometry/mend_surface.h"
#include "runtime/core/error.h"
#include "tests/simulate/limb.h"
#include "trainer/tets/tets.h"

namespace bodyopt::trainer {
namespace {

FillableSkin fillable(const Character& character) {
  return fillable_skin(character.vertices, character.triangles, character.weights);
}

// A limb, and a small closed piece of the same joints around `centre`.
Character with_lump(const Eigen::RowVector3d& centre, double size) {
  Character limb = make_limb();
  const Eigen::Index v = limb.vertices.rows(), t = limb.triangles.rows();
  limb.vertices.conservativeResize(v + 4, 3);
  limb.triangles.conservativeResize(t + 4, 3);
  limb.vertices.row(v) = centre;
  const auto at = [&](Eigen::Index k) { return static_cast<std::uint32_t>(v + k); };
  for (int k = 0; k < 3; ++k) limb.vertices.row(v + 1 + k) = centre + size * Eigen::RowVector3d::Unit(k);
  limb.triangles.row(t) << at(0), at(2), at(1);
  limb.triangles.row(t + 1) << at(0), at(1), at(3);
  limb.triangles.row(t + 2) << at(1), at(2), at(3);
  limb.triangles.row(t + 3) << at(0), at(3), at(2);
  Eigen::Index near = 0;
  (limb.vertices.topRows(v).rowwise() - centre).rowwise().squaredNorm().minCoeff(&near);
  for (int k = 0; k < 4; ++k) limb.weights.push_back(limb.weights[static_cast<std::size_t>(near)]);
  return limb;
}

TEST(FillableSkin, ASoundSkinStaysAsItIs) {
  const Character limb = make_limb();
  const FillableSkin skin = fillable(limb);
  EXPECT_EQ(skin.mending(), "");
  EXPECT_EQ(skin.vertices, limb.vertices);
  EXPECT_EQ(skin.triangles, limb.triangles);
  EXPECT_EQ(skin.pieces, 1);
}

TEST(FillableSkin, TurnsFlippedTrianglesAndDropsDoubledOnes) {
  const Character limb = make_limb();
  Character damaged = limb;
  for (const Eigen::Index t : {3, 40, 41, 90}) std::swap(damaged.triangles(t, 0), damaged.triangles(t, 2));
  damaged.triangles.conservativeResize(limb.triangles.rows() + 2, 3);
  damaged.triangles.bottomRows(2) = limb.triangles.topRows(2);
  const FillableSkin skin = fillable(damaged);
  EXPECT_EQ(skin.turned, 4);
  EXPECT_EQ(skin.doubled, 2);
  EXPECT_NO_THROW(require_closed(skin.vertices, skin.triangles));
  EXPECT_NEAR(enclosed_volume(skin.vertices, skin.triangles), std::abs(enclosed_volume(limb.vertices, limb.triangles)),
              1e-12);
}

TEST(FillableSkin, FillsHolesAndRefusesSheets) {
  Character limb = make_limb();
  const double volume = std::abs(enclosed_volume(limb.vertices, limb.triangles));
  const Triangles whole = limb.triangles;
  limb.triangles = whole.topRows(whole.rows() - 3);
  const FillableSkin skin = fillable(limb);
  EXPECT_GT(skin.filled, 0);
  EXPECT_NO_THROW(require_closed(skin.vertices, skin.triangles));
  EXPECT_NEAR(enclosed_volume(skin.vertices, skin.triangles) / volume, 1, 0.02);
  limb.triangles = whole.topRows(whole.rows() / 2);
  EXPECT_THROW(fillable(limb), Error);
}

// A fin on the back of the limb: its foot are edges of the skin, which so have three triangles.
TEST(FillableSkin, SheetsThatShareEdgesAreCutOffAndRide) {
  const Character plain = make_limb();
  Character limb = plain;
  const Eigen::Index count = plain.vertices.rows(), triangles = plain.triangles.rows();
  limb.vertices.conservativeResize(count + 2, 3);
  limb.triangles.conservativeResize(triangles + 3, 3);
  const auto low = static_cast<std::uint32_t>(count), high = low + 1;
  for (int k = 0; k < 2; ++k) {
    limb.vertices.row(count + k) = plain.vertices.row(60) + Eigen::RowVector3d(0.02 * k, 0.1, 0);
    limb.weights.push_back(plain.weights[60]);
  }
  limb.triangles.row(triangles) << 50, 60, low;  // neighbours along the limb
  limb.triangles.row(triangles + 1) << 60, 70, low;
  limb.triangles.row(triangles + 2) << 70, high, low;
  const FillableSkin skin = fillable(limb);
  EXPECT_EQ(skin.cut, 3);
  EXPECT_EQ(skin.loose_pieces, std::vector<std::uint32_t>{low}) << "both its vertices are one piece";
  EXPECT_EQ(skin.pieces, 1);
  EXPECT_EQ(skin.vertices, plain.vertices);
  EXPECT_NO_THROW(require_closed(skin.vertices, skin.triangles));
  EXPECT_NE(skin.mending().find("3 triangles of sheets"), std::string::npos) << skin.mending();
}

// Rest in the tets, and an affine motion of these, take every vertex along: loose pieces, moved ones, merged ones.
TEST(FillableSkin, WhatRidesIsCarried) {
  const Character plain = make_limb();
  const Character limb = with_lump(plain.vertices.colwise().mean(), 0.01);
  const FillableSkin skin = fillable(limb);
  ASSERT_EQ(skin.loose_pieces.size(), 1u);
  EXPECT_EQ(skin.pieces, 1);
  EXPECT_EQ(skin.vertices.rows(), plain.vertices.rows());
  const TetMesh mesh = tetrahedralise(skin.vertices, skin.triangles, 0.05);
  const std::vector<EmbeddedPoint> points =
      carry_skin(skin, limb.vertices, mesh, own_nodes(mesh, skin.vertices.rows()));
  EXPECT_LT((embed(points, mesh.tets, mesh.nodes) - limb.vertices).cwiseAbs().maxCoeff(), 1e-12);
  Eigen::Matrix3d affine;
  affine << 0.9, 0.2, 0, -0.3, 1.1, 0.1, 0.05, 0, 1;
  EXPECT_LT((embed(points, mesh.tets, mesh.nodes * affine) - limb.vertices * affine).cwiseAbs().maxCoeff(), 1e-12);
}

// A large piece of other joints that is stuck in the limb would be torn from these joints.
TEST(FillableSkin, LargePiecesOfOtherJointsDoNotRide) {
  const Character plain = make_limb();
  Character limb = with_lump(plain.vertices.colwise().mean(), 0.4);
  for (std::size_t v = static_cast<std::size_t>(plain.vertices.rows()); v < limb.weights.size(); ++v) {
    limb.weights[v] = {{limb.weights[v].front().joint == 0 ? 1u : 0u, 1.0}};
  }
  try {
    fillable(limb);
    FAIL() << "it rides";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mismatch);
    EXPECT_NE(std::string(error.what()).find("follows other joints"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace bodyopt::trainer
