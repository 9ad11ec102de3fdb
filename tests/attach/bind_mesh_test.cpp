// Which pieces are bound to what, and what is refused.
#include "trainer/attach/bind_mesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "runtime/core/error.h"
#include "tests/support/attached_limb.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::trainer {
namespace {

AttachedMesh bound(const LooseMesh& mesh, const AttachOptions& options = {}) {
  return bind_mesh(mesh, RestSkin(limb_basis()), options);
}

void expect_bound(const LooseMesh& mesh, const std::string& how) {
  EXPECT_EQ(bound(mesh).bound.rfind(how, 0), 0u) << mesh.name << ": " << bound(mesh).bound << ", expected " << how;
}

LooseMesh joined(LooseMesh a, const LooseMesh& b) {
  const auto base = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& [p, q, r] : b.triangles) a.triangles.push_back({base + p, base + q, base + r});
  return a;
}

TEST(BindMesh, EveryPieceByItself) {
  const LooseMesh eye = sphere_at("eye", {0, 0, 0.1}, 0.008), button = sphere_at("button", {0.057, 0, 0.4}, 0.006);
  expect_bound(eye, "1 piece fixed to joint 'joint0'");
  expect_bound(button, "1 piece fixed to the skin");
  expect_bound(sleeve(0.008), "1 piece following the skin");
  expect_bound(blade(), "1 piece fixed to joint 'joint2'");
  expect_bound(joined(eye, button), "1 piece fixed to joint 'joint0', 1 piece fixed to the skin");
}

TEST(BindMesh, SmallPiecesInsideOrAroundGoWithTheJoint) {
  expect_bound(sphere_at("tooth", {0.035, 0, 0.4}, 0.006), "1 piece fixed to joint 'joint1'");  // under one side
  Character finger = limb_character();
  finger.vertices.leftCols(2) *= 0.1;
  const Basis basis = build_ddm_basis(finger, {});
  LooseMesh ring = sleeve(0);
  for (Vec3& p : ring.vertices) p = {0.16 * p[0], 0.16 * p[1], 0.4 + 0.02 * (p[2] - 0.3)};
  const AttachedMesh mesh = bind_mesh(ring, RestSkin(basis), {});
  EXPECT_EQ(mesh.bound.rfind("1 piece fixed to joint 'joint1'", 0), 0u) << mesh.bound;
}

TEST(BindMesh, WhatHangsOnAJointStaysThere) {
  LooseMesh mesh = sleeve(0.008);
  mesh.joint = 1;
  expect_bound(mesh, "1 piece fixed to joint 'joint1'");
  mesh.vertices[0] = {0, 0, 40};  // and nobody asks how far it is
  expect_bound(mesh, "1 piece fixed to joint 'joint1'");
}

TEST(BindMesh, OwnWeightsSayWhichJoint) {
  LooseMesh mesh = blade();
  mesh.weights.assign(mesh.vertices.size(), {{1, 1.0}});
  expect_bound(mesh, "1 piece fixed to joint 'joint1'");
  mesh.weights[0] = {{0, 0.5}, {1, 0.5}};  // a coat's tail: it must bend
  expect_bound(mesh, "1 piece following the skin");
}

TEST(BindMesh, ModesAreObeyed) {
  const LooseMesh mesh = sleeve(0.008);
  const AttachedMesh piece = bound(mesh, {.mode = AttachMode::piece});
  EXPECT_EQ(piece.anchors.size(), 1u);
  EXPECT_EQ(piece.points.size(), 64u);
  const AttachedMesh joint = bound(mesh, {.mode = AttachMode::joint, .joint = 2});
  ASSERT_EQ(joint.anchors.size(), 1u);
  EXPECT_EQ(joint.anchors[0].joint, 2u);
  EXPECT_TRUE(joint.points.empty());
  const AttachedMesh skin = bound(blade(), {.mode = AttachMode::skin});
  EXPECT_EQ(skin.anchors.size(), 5u);
  EXPECT_EQ(skin.points.size(), 5u);
}

TEST(BindMesh, SeamDuplicatesAreOnePieceAndOneAnchor) {
  LooseMesh mesh = blade();
  mesh.vertices.push_back(mesh.vertices[4]);
  mesh.triangles[2] = {3, 2, 5};
  mesh.triangles[3] = {2, 0, 5};
  const AttachedMesh cut = bound(mesh, {.mode = AttachMode::skin});
  EXPECT_EQ(cut.anchors.size(), 5u);
  EXPECT_EQ(cut.vertex_anchor[4], cut.vertex_anchor[5]);
  EXPECT_EQ(cut.bound.rfind("1 piece ", 0), 0u) << cut.bound;
  EXPECT_EQ(cut.rest.size(), 18u);
}

// Each vertex's anchor lies on its own side of the limb, whichever way the cloth's triangles face.
TEST(BindMesh, ClothAndLiningBindToTheSkinUnderThem) {
  LooseMesh lining = sleeve(0.008);
  for (auto& [a, b, c] : lining.triangles) std::swap(b, c);
  for (const LooseMesh& cloth : {sleeve(0.008), lining}) {
    const AttachedMesh mesh = bound(cloth, {.mode = AttachMode::skin});
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
      const AttachmentAnchor& anchor = mesh.anchors[mesh.vertex_anchor[v]];
      const float off = std::hypot(anchor.x - mesh.rest[3 * v], anchor.y - mesh.rest[3 * v + 1]);
      EXPECT_LT(off, 0.01f) << v;
    }
  }
}

// Under an arm: nearer to the flank, but facing as the arm does.
TEST(RestSkin, SkinThatFacesTheSameWayIsPreferredUpToTwiceTheDistance) {
  const RestSkin skin(limb_basis());
  const Eigen::Vector3d near(0.04, 0, 0.2);  // 10 mm off one side; the other begins 64 mm away
  EXPECT_GT(skin.facing(near, {1, 0, 0}).position.x(), 0.04);
  EXPECT_GT(skin.facing(near, {-1, 0, 0}).position.x(), 0.04);
  const Eigen::Vector3d middle(0.01, 0, 0.2);  // 40 and 51 mm
  EXPECT_GT(skin.facing(middle, {1, 0, 0}).position.x(), 0.04);
  EXPECT_LT(skin.facing(middle, {-1, 0, 0}).position.x(), 0.005);
}

// Shrunk, it would be near: so is whatever shrinks onto the origin.
TEST(BindMesh, WhatIsMerelyFarAwayIsInNoOtherUnit) {
  for (const double away : {2.0, 3.0, 4.0, 5.0, 6.0}) {
    LooseMesh mesh = sleeve(0.008);
    for (Vec3& p : mesh.vertices) p = p + Vec3{0, away, 0};
    try {
      bound(mesh);
      ADD_FAILURE() << "accepted at " << away;
    } catch (const Error& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find("is it elsewhere"), std::string::npos) << text;
      EXPECT_EQ(text.find("With --unit"), std::string::npos) << text;
    }
  }
}

TEST(BindMesh, AnotherUnitIsNamed) {
  LooseMesh mesh = sleeve(0.008);
  for (Vec3& p : mesh.vertices) p = 100.0 * p;
  try {
    bound(mesh, {.unit = 0.5});
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mismatch);
    const std::string text = error.what();
    EXPECT_NE(text.find("mesh 'sleeve' is 15.51 m from the skin"), std::string::npos) << text;
    EXPECT_NE(text.find("With --unit 0.005 it is"), std::string::npos) << text;
  }
  for (Vec3& p : mesh.vertices) p = p + Vec3{0, 700, 0};
  try {
    bound(mesh);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("is it elsewhere"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace bodyopt::trainer
