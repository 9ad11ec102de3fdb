#include "trainer/tets/tets.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "geometry/mend_surface.h"
#include "runtime/core/error.h"
#include "tests/simulate/limb.h"
#include "tests/support/stand_in_human.h"

namespace bodyopt::trainer {
namespace {

void expect_refused(const Positions& vertices, const Triangles& triangles, const std::string& defect,
                    ErrorCause cause) {
  try {
    tetrahedralise(vertices, triangles, 0.05);
    FAIL() << "expected the skin to be refused for: " << defect;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mismatch);
    EXPECT_EQ(error.cause(), cause) << error.what();
    EXPECT_NE(std::string(error.what()).find(defect), std::string::npos) << error.what();
  }
}

TEST(Tets, FillTheSkinAndKeepItsVertices) {
  const Character limb = make_limb();
  const TetMesh mesh = tetrahedralise(limb.vertices, limb.triangles, 0.05);
  EXPECT_EQ(mesh.nodes.topRows(limb.vertices.rows()), limb.vertices);
  EXPECT_NEAR(volume(mesh), enclosed_volume(limb.vertices, limb.triangles), 1e-12);
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) EXPECT_GT(tet_edges(mesh, t).determinant(), 0);
  EXPECT_GT(mesh.worst_quality, 0.1);
  EXPECT_LE(mesh.worst_quality, 1);
}

TEST(Tets, AreTheSameEveryTime) {
  const Character limb = make_limb();
  const TetMesh a = tetrahedralise(limb.vertices, limb.triangles, 0.05);
  const TetMesh b = tetrahedralise(limb.vertices, limb.triangles, 0.05);
  EXPECT_EQ(a.nodes, b.nodes);
  EXPECT_EQ(a.tets, b.tets);
}

TEST(Tets, SayNothingOnStandardOutput) {
  const Character limb = make_limb();
  ::testing::internal::CaptureStdout();
  tetrahedralise(limb.vertices, limb.triangles, 0.05);
  std::puts("after");  // and standard output works again
  std::fflush(stdout);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "after\n");
}

TEST(Tets, FillASkinThatWindsInwards) {
  Character limb = make_limb();
  limb.triangles.col(1).swap(limb.triangles.col(2));
  const TetMesh mesh = tetrahedralise(limb.vertices, limb.triangles, 0.05);
  EXPECT_NEAR(volume(mesh), -enclosed_volume(limb.vertices, limb.triangles), 1e-12);
}

TEST(Tets, RefuseDefectsByName) {
  const Character limb = make_limb();
  const Eigen::Index count = limb.triangles.rows();
  expect_refused(limb.vertices, limb.triangles.topRows(count - 1), "open: 3 boundary edges", ErrorCause::open_edges);
  Triangles changed = limb.triangles;
  std::swap(changed(5, 1), changed(5, 2));
  expect_refused(limb.vertices, changed, "3 edges join triangles that wind oppositely", ErrorCause::flipped_edges);
  changed = limb.triangles;
  changed(0, 0) = 1u << 30;
  expect_refused(limb.vertices, changed, "missing vertex", ErrorCause::damaged);
  Positions loose(limb.vertices.rows() + 1, 3);
  loose << limb.vertices, Eigen::RowVector3d(9, 9, 9);
  expect_refused(loose, limb.triangles, "1 vertices belong to no triangle", ErrorCause::loose_vertices);
  Positions broken = limb.vertices;
  broken(3, 1) = std::nan("");
  expect_refused(broken, limb.triangles, "not a finite number", ErrorCause::damaged);
  expect_refused(Positions(0, 3), Triangles(0, 3), "no triangles", ErrorCause::no_faces);
}

TEST(Tets, RefuseASkinThatIntersectsItself) {
  Character limb = make_limb();
  for (Eigen::Index v = 5 * kTubeSides; v < 6 * kTubeSides; ++v) limb.vertices(v, 0) += 0.3;
  expect_refused(limb.vertices, limb.triangles, "cannot be filled", ErrorCause::unfillable);
}

TEST(Tets, FillAHuman) {
  for (const Character& man : humans("characters/cesium_man.glb")) {
    const TetMesh mesh = tetrahedralise(man.vertices, man.triangles, 0.1);
    EXPECT_NEAR(volume(mesh), std::abs(enclosed_volume(man.vertices, man.triangles)), 1e-9);
    EXPECT_GT(mesh.worst_quality, 0.05);
  }
}

}  // namespace
}  // namespace bodyopt::trainer
