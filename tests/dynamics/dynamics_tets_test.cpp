#include "trainer/dynamics/dynamics_tets.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>

#include "geometry/mend_surface.h"
#include "runtime/basis/dynamics.h"
#include "runtime/core/error.h"
#include "tests/builtin/shared_arm.h"
#include "tests/simulate/limb.h"

namespace bodyopt::trainer {
namespace {

// Whatever linear map moves the skin moves the nodes on it and what the tets carry.
void expect_linear_precision(const DynamicsTets& tets, const Positions& skin) {
  Eigen::Matrix3d linear;
  linear << 0.2, -1.1, 0.4, 0.9, 0.3, -0.2, 0.1, 0.5, 1.3;
  const Positions moved = skin * linear.transpose(), nodes = tets.cage.mesh.nodes * linear.transpose();
  double on_skin = 0;
  for (std::size_t n = 0; n < tets.surface.size(); ++n) {
    const SkinPoint& point = tets.surface[n];
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      sum += point.weights[static_cast<Eigen::Index>(k)] * moved.row(point.vertices[k]);
    }
    on_skin = std::max(on_skin, (sum - nodes.row(static_cast<Eigen::Index>(n))).norm());
  }
  EXPECT_LT(on_skin, 1e-7);  // metres: nodes are rounded to single precision
  const Positions carried = embed(tets.cage.skin, tets.cage.mesh.tets, nodes);
  std::size_t inside = 0;
  for (std::size_t v = 0; v < tets.cage.skin.size(); ++v) {
    if (tets.cage.skin[v].weights.minCoeff() < -0.299) continue;  // those further out are brought near
    ++inside;
    const auto row = static_cast<Eigen::Index>(v);
    EXPECT_LT((carried.row(row) - moved.row(row)).cwiseAbs().maxCoeff(), 1e-12);
  }
  EXPECT_GT(inside, tets.cage.skin.size() / 2);
}

TEST(DynamicsTets, CoarserSkinLiesOnTheSkinAndFillsIt) {
  const Character& character = arm().character;
  const Eigen::Index most = 6000;
  const DynamicsTets tets = make_dynamics_tets(character.vertices, character.triangles, character.weights, most);
  const TetMesh& mesh = tets.cage.mesh;
  EXPECT_LE(mesh.tets.rows(), most);
  EXPECT_GT(mesh.tets.rows(), 0.85 * static_cast<double>(most));
  EXPECT_LT(tets.surface.size(), static_cast<std::size_t>(character.vertices.rows()));
  EXPECT_NEAR(volume(mesh) / enclosed_volume(character.vertices, character.triangles), 1, 0.05);
  EXPECT_GE(tet_quality(mesh).worst, 0.05);
  expect_linear_precision(tets, character.vertices);
}

// Beyond a tet a vertex does not swing much further than its corners.
TEST(DynamicsTets, SkinIsCarriedFromNear) {
  const Character limb = make_limb();
  const DynamicsTets tets = make_dynamics_tets(limb.vertices, limb.triangles, limb.weights, 600);
  double least = 0;
  for (const EmbeddedPoint& point : tets.cage.skin) {
    EXPECT_NEAR(point.weights.sum(), 1, 1e-12);
    least = std::min(least, point.weights.minCoeff());
  }
  EXPECT_LT(least, 0);  // chords cut corners
  EXPECT_GE(least, -0.3 - 1e-12);
}

TEST(DynamicsTets, SkinOfFewVerticesIsFilledAsItIs) {
  const Character limb = make_limb();
  const DynamicsTets tets = make_dynamics_tets(limb.vertices, limb.triangles, limb.weights, 25000);
  ASSERT_EQ(tets.surface.size(), static_cast<std::size_t>(limb.vertices.rows()));
  for (std::size_t v = 0; v < tets.surface.size(); ++v) {
    EXPECT_EQ(tets.surface[v].vertices[0], v);
    EXPECT_EQ(tets.surface[v].weights, Eigen::Vector3d(1, 0, 0));
    EXPECT_EQ(tets.cage.mesh.tets.row(tets.cage.skin[v].tet).cast<double>().dot(tets.cage.skin[v].weights), v);
  }
  expect_linear_precision(tets, limb.vertices.cast<float>().cast<double>());
}

TEST(DynamicsTets, TableHoldsTheShapes) {
  const Character limb = make_limb();
  const DynamicsTets tets = make_dynamics_tets(limb.vertices, limb.triangles, limb.weights, 25000);
  const std::vector<double> amounts(tets.cage.skin.size(), 0.25);
  const TetTable table = make_tet_table(tets, amounts, std::vector<double>(amounts.size(), 0.1));
  ASSERT_EQ(table.tet_count(), static_cast<std::uint32_t>(tets.cage.mesh.tets.rows()));
  double total = 0;
  for (Eigen::Index t = 0; t < tets.cage.mesh.tets.rows(); ++t) {
    const TetShape& shape = table.shapes[static_cast<std::size_t>(t)];
    const Eigen::Matrix<float, 3, 3, Eigen::RowMajor> inverse(shape.inverse_edges);
    EXPECT_LT((inverse.cast<double>() * tet_edges(tets.cage.mesh, t) - Eigen::Matrix3d::Identity()).norm(), 1e-5);
    EXPECT_GT(shape.volume, 0);
    total += static_cast<double>(shape.volume);
  }
  EXPECT_NEAR(total / enclosed_volume(limb.vertices, limb.triangles), 1, 1e-5);
  for (std::size_t n = 0; n < table.node_count(); ++n) {
    ASSERT_LT(table.corner_begin[n], table.corner_begin[n + 1]);
    for (std::uint32_t k = table.corner_begin[n]; k < table.corner_begin[n + 1]; ++k) {
      ASSERT_EQ(table.tets[table.corners[k]], n);
    }
  }
  EXPECT_EQ(table.skin[7].amount, 0.25f);
}

TEST(DynamicsTets, OpenSkinIsRefusedWithTheCause) {
  const Character limb = make_limb();
  const Triangles open = limb.triangles.topRows(limb.triangles.rows() / 2);
  try {
    make_dynamics_tets(limb.vertices, open, limb.weights, 25000);
    FAIL() << "filled";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mismatch);
    EXPECT_NE(std::string(error.what()).find("boundary edges"), std::string::npos) << error.what();
  }
}

TetMesh two_tets() {
  TetMesh mesh;
  mesh.nodes.resize(5, 3);
  mesh.nodes << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1;
  mesh.tets.resize(2, 4);
  mesh.tets << 0, 1, 2, 3, 1, 2, 3, 4;
  orient(mesh);
  return mesh;
}

TEST(TetQuality, DefectsAreNamed) {
  EXPECT_NO_THROW(require_sound(two_tets()));
  const auto expect = [](const char* named, const std::function<void(TetMesh&)>& change) {
    TetMesh mesh = two_tets();
    change(mesh);
    try {
      require_sound(mesh);
      ADD_FAILURE() << "accepted: " << named;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::mismatch);
      EXPECT_NE(std::string(error.what()).find(named), std::string::npos) << error.what();
    }
  };
  expect("tetrahedron 1 is inverted", [](TetMesh& m) { std::swap(m.tets(1, 0), m.tets(1, 1)); });
  expect("tetrahedron 0 is flat", [](TetMesh& m) { m.nodes.row(3) << 0.3, 0.3, 0; });
  expect("tetrahedron 1 names node 5 of 5", [](TetMesh& m) { m.tets(1, 2) = 5; });
  expect("tetrahedron 0 names node -1", [](TetMesh& m) { m.tets(0, 2) = -1; });
  expect("node 5 belongs to no tetrahedron", [](TetMesh& m) { m.nodes.conservativeResizeLike(Positions::Zero(6, 3)); });
  expect("not a finite number", [](TetMesh& m) { m.nodes(2, 1) = std::numeric_limits<double>::quiet_NaN(); });
  expect("there are none", [](TetMesh& m) { m.tets.resize(0, 4); });
}

TEST(TetQuality, IsOneOfTheRegularTetAndAsDefinedOfACubesCorner) {
  TetMesh mesh;
  mesh.nodes.resize(4, 3);
  mesh.nodes << 1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1;
  mesh.tets.resize(1, 4);
  mesh.tets << 0, 1, 2, 3;
  orient(mesh);
  EXPECT_NEAR(tet_quality(mesh).worst, 1, 1e-12);
  mesh.nodes << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;  // 12 (3 / 6)^(2/3) over squared edges 1 + 1 + 1 + 2 + 2 + 2
  orient(mesh);
  EXPECT_NEAR(tet_quality(mesh).median, 12 * std::pow(0.5, 2.0 / 3) / 9, 1e-12);
}

}  // namespace
}  // namespace bodyopt::trainer
