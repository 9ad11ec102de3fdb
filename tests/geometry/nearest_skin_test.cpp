#include "geometry/nearest_skin.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "tests/builtin/shared_arm.h"

namespace bodyopt {
namespace {

TEST(NearestSkin, IsTheNearestOfAllTriangles) {
  const Character& character = arm().character;
  const NearestSkin nearest(character.vertices, character.triangles);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-0.1, 0.9);
  for (int k = 0; k < 40; ++k) {
    const Eigen::Vector3d point(uniform(random), uniform(random), uniform(random));
    const SkinPoint found = nearest(point);
    const double distance = (found.position - point).norm();
    double sampled = 1e300;  // of points spread over every triangle: none may be nearer
    for (Eigen::Index t = 0; t < character.triangles.rows(); ++t) {
      for (int i = 0; i <= 4; ++i) {
        for (int j = 0; i + j <= 4; ++j) {
          const Eigen::RowVector3d p = (i * character.vertices.row(character.triangles(t, 0)) +
                                        j * character.vertices.row(character.triangles(t, 1)) +
                                        (4 - i - j) * character.vertices.row(character.triangles(t, 2))) /
                                       4;
          sampled = std::min(sampled, (p.transpose() - point).norm());
        }
      }
    }
    EXPECT_LE(distance, sampled + 1e-12);
    EXPECT_GT(distance, sampled - 0.01);
    const auto corners = character.triangles.row(found.triangle);
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    for (int a = 0; a < 3; ++a) at += found.weights[a] * character.vertices.row(corners[a]).transpose();
    EXPECT_LT((at - found.position).norm(), 1e-12);
    // The nearest that faces away from the point is another.
    const Eigen::Vector3d away = (found.position - point).normalized();
    const SkinPoint behind = nearest.facing(point, away);
    ASSERT_GE(behind.triangle, 0);
    EXPECT_GE((behind.position - point).norm(), distance);
    const auto other = character.triangles.row(behind.triangle);
    const Eigen::Vector3d a = character.vertices.row(other[0]), b = character.vertices.row(other[1]),
                          c = character.vertices.row(other[2]);
    EXPECT_GT((b - a).cross(c - a).dot(away), 0);
  }
}

// A fan around a vertex, above which all of its triangles are as near; a metre away from where coordinates are exact,
// too.
TEST(NearestSkin, OfTrianglesEquallyNearTheFirst) {
  Positions vertices(7, 3);
  Triangles triangles(6, 3);
  vertices.row(6).setZero();
  for (std::uint32_t k = 0; k < 6; ++k) {
    const double angle = k * EIGEN_PI / 3;
    vertices.row(k) << std::cos(angle), std::sin(angle), 0;
    triangles.row((5 * k + 3) % 6) << 6, k, (k + 1) % 6;
  }
  for (const double height : {0.0, 1.0}) {
    vertices.col(2).setConstant(height);
    const NearestSkin nearest(vertices, triangles);
    for (const double above : {0.0, 1e-4, 0.5}) EXPECT_EQ(nearest({0, 0, height + above}).triangle, 0) << above;
  }
}

}  // namespace
}  // namespace bodyopt
