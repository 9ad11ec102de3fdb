// Distances to simple shapes, by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "trainer/anatomy/bone.h"

namespace {

using namespace trainer;

using bodyopt::trainer::cone_distance;
using Eigen::Vector3d;

TEST(Shapes, BallsAndConesBetweenThem) {
  EXPECT_DOUBLE_EQ(bodyopt::trainer::sphere_distance({3, 4, 0}, {0, 0, 0}, 1), 4);
  EXPECT_DOUBLE_EQ(bodyopt::trainer::sphere_distance({0, 0, 0.25}, {0, 0, 0}, 1), -0.75);
  const Vector3d a(0, 0, 0), b(2, 0, 0);
  EXPECT_DOUBLE_EQ(cone_distance({1, 1, 0}, a, b, 0.2, 0.4), 0.7);    // half way: 0.3 thick
  EXPECT_DOUBLE_EQ(cone_distance({3, 0, 0}, a, b, 0.2, 0.4), 0.6);    // beyond the ball at the end
  EXPECT_DOUBLE_EQ(cone_distance({0, 0.5, 0}, a, a, 0.2, 0.4), 0.3);  // no way between: a ball
}

TEST(Shapes, ChainIsTheNearestOfItsLinks) {
  const std::vector<bodyopt::trainer::ChainLink> chain{{{0, 0, 0}, 0.1}, {{1, 0, 0}, 0.1}, {{1, 1, 0}, 0.3}};
  EXPECT_DOUBLE_EQ(bodyopt::trainer::chain_distance({0.5, 0.5, 0}, chain), 0.3);   // to the second, 0.2 thick there
  EXPECT_DOUBLE_EQ(bodyopt::trainer::chain_distance({0.2, -0.4, 0}, chain), 0.3);  // to the first
}

TEST(Shapes, EllipsoidHasItsRadiiAlongItsAxes) {
  Eigen::Matrix3d axes;  // turned a quarter about z
  axes << 0, 1, 0, -1, 0, 0, 0, 0, 1;
  const Vector3d centre(1, 2, 3), radii(3, 2, 1);
  EXPECT_NEAR(bodyopt::trainer::ellipsoid_distance({1, 5, 3}, centre, axes, radii), 0, 1e-12);
  EXPECT_NEAR(bodyopt::trainer::ellipsoid_distance({-1, 2, 3}, centre, axes, radii), 0, 1e-12);
  EXPECT_NEAR(bodyopt::trainer::ellipsoid_distance({1, 2, 4}, centre, axes, radii), 0, 1e-12);
  EXPECT_NEAR(bodyopt::trainer::ellipsoid_distance(centre, centre, axes, radii), -1, 1e-12);
}

TEST(Shapes, PlateIsATriangleThickOnBothSides) {
  const Vector3d a(0, 0, 0), b(2, 0, 0), c(0, 2, 0);
  EXPECT_DOUBLE_EQ(bodyopt::trainer::plate_distance({0.5, 0.5, 0.3}, a, b, c, 0.1), 0.2);
  EXPECT_DOUBLE_EQ(bodyopt::trainer::plate_distance({0.5, 0.5, -0.3}, a, b, c, 0.1), 0.2);
  EXPECT_DOUBLE_EQ(bodyopt::trainer::plate_distance({0.5, 0.5, 0.05}, a, c, b, 0.1), -0.05);  // whichever way it winds
  EXPECT_DOUBLE_EQ(bodyopt::trainer::plate_distance({1, -0.5, 0}, a, b, c, 0.1), 0.4);        // beside an edge
  EXPECT_NEAR(bodyopt::trainer::plate_distance({2, 2, 0}, a, b, c, 0), std::sqrt(2), 1e-12);
}

}  // namespace
