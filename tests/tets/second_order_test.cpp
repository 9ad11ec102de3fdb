#include "trainer/tets/second_order.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "tests/simulate/limb.h"

namespace bodyopt::trainer {
namespace {

class SecondOrder : public ::testing::Test {
 protected:
  const Character limb_ = make_limb();
  const Cage linear_ = own_cage(limb_.vertices, limb_.triangles, limb_.weights, 0.05);
  const Cage cage_ = second_order(linear_);
};

TEST_F(SecondOrder, EighthsFillTheirTet) {
  ASSERT_TRUE(cage_.mesh.is_second_order);
  ASSERT_EQ(cage_.mesh.tets.rows(), 8 * linear_.mesh.tets.rows());
  for (Eigen::Index t = 0; t < cage_.mesh.tets.rows(); ++t) {
    const double whole = tet_edges(linear_.mesh, t / 8).determinant();
    EXPECT_NEAR(tet_edges(cage_.mesh, t).determinant(), whole / 8, 1e-9 * whole);
  }
  // Every face is shared or on the surface, which has four times as many.
  EXPECT_EQ(surface_of(cage_.mesh.tets).rows(), 4 * limb_.triangles.rows());
}

TEST_F(SecondOrder, NodesAreCornersAndMiddlesWithTheSurfaceFirst) {
  const Eigen::Index skin = limb_.vertices.rows();
  EXPECT_EQ(cage_.mesh.nodes.topRows(skin), limb_.vertices);
  EXPECT_EQ(surface_of(cage_.mesh.tets).maxCoeff() + 1, skin + limb_.triangles.rows() * 3 / 2);
  for (Eigen::Index t = 0; t < linear_.mesh.tets.rows(); ++t) {
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        const Eigen::RowVector3d middle =
            (linear_.mesh.nodes.row(linear_.mesh.tets(t, a)) + linear_.mesh.nodes.row(linear_.mesh.tets(t, b))) / 2;
        EXPECT_EQ(cage_.mesh.nodes.row(cage_.mesh.tets(8 * t + a, b)), middle);
      }
    }
  }
}

TEST_F(SecondOrder, WhatTheTetsCarryLiesWhereItLay) {
  for (std::size_t v = 0; v < cage_.skin.size(); ++v) {
    EXPECT_LT((rest_position(cage_.mesh, cage_.skin[v]) - rest_position(linear_.mesh, linear_.skin[v])).norm(), 1e-12);
    EXPECT_GE(cage_.skin[v].weights.minCoeff(), -1e-9);
    EXPECT_EQ(cage_.skin[v].tet / 8, linear_.skin[v].tet);
  }
}

TEST_F(SecondOrder, NodesAreReachedFromCornersAsTheyLie) {
  const Eigen::SparseMatrix<double> matrix = from_corners(cage_.mesh);
  ASSERT_EQ(matrix.cols(), linear_.mesh.nodes.rows());
  EXPECT_LT((matrix * linear_.mesh.nodes - cage_.mesh.nodes).cwiseAbs().maxCoeff(), 1e-15);
}

// Outside a tet, too: by the eighth that is nearest.
TEST_F(SecondOrder, PointsAnywhereKeepTheirPlace) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-0.5, 1);
  Cage cage = linear_;
  for (EmbeddedPoint& point : cage.skin) {
    point.weights.tail<3>() << uniform(random), uniform(random), uniform(random);
    point.weights[0] = 1 - point.weights.tail<3>().sum();
  }
  const Cage cut = second_order(cage);
  for (std::size_t v = 0; v < cage.skin.size(); ++v) {
    EXPECT_LT((rest_position(cut.mesh, cut.skin[v]) - rest_position(cage.mesh, cage.skin[v])).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace bodyopt::trainer
