// Paths around spheres and cylinders whose lengths are worked out by hand: a path from a point at twice the radius
// meets the surface sqrt(3) radii further on, 60 degrees around it.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "trainer/muscle_models/model.h"

namespace bodyopt::trainer::muscle_models {
namespace {

using Eigen::Vector3d;
using Side = std::optional<Vector3d>;

constexpr auto kSphere = Wrap::Shape::sphere, kCylinder = Wrap::Shape::cylinder;
constexpr double kPi = std::numbers::pi, kTangents = 2 * std::numbers::sqrt3;

Vector3d around(double degrees, double distance, double z = 0) {
  return {distance * std::cos(degrees * kPi / 180), distance * std::sin(degrees * kPi / 180), z};
}

double bent_length(const std::optional<Arc>& arc, const Vector3d& start, const Vector3d& end) {
  return arc ? (arc->from - start).norm() + arc->length + (end - arc->to).norm() : 0;
}

// Around radius 1, from 0 degrees to `degrees`, both at distance 2; 0 where the path stays straight.
double unit_length(Wrap::Shape shape, const Side& side, double degrees) {
  const Vector3d start = around(0, 2), end = around(degrees, 2);
  return bent_length(wrap_around(shape, 1, side, start, end), start, end);
}

TEST(Wrap, GoesTheShorterWayOrThatOfItsSide) {
  for (const Wrap::Shape shape : {kSphere, kCylinder}) {
    EXPECT_NEAR(unit_length(shape, std::nullopt, 150), kTangents + kPi / 6, 1e-12);
    EXPECT_NEAR(unit_length(shape, around(75, 3), 150), kTangents + kPi / 6, 1e-12);
    EXPECT_NEAR(unit_length(shape, around(255, 3), 150), kTangents + kPi / 2, 1e-12);
  }
}

TEST(Wrap, APathThatMissesTheSurfaceBendsOnlyWhenItIsOnTheWrongSide) {
  for (const Wrap::Shape shape : {kSphere, kCylinder}) {
    EXPECT_FALSE(wrap_around(shape, 1, std::nullopt, around(0, 2), around(90, 2)));
    EXPECT_FALSE(wrap_around(shape, 1, around(45, 3), around(0, 2), around(90, 2)));
    EXPECT_NEAR(unit_length(shape, around(225, 3), 90), kTangents + kPi * 5 / 6, 1e-12);
  }
}

// What counts is the distance of the side from the surface's centre, not from its axis nor in the plane of the bend, as
// in MuJoCo from 3.2.3 on: such a path went straight through a sphere before.
TEST(Wrap, ASideBesideThePlaneOfTheBendIsOutside) {
  EXPECT_NEAR(unit_length(kSphere, around(255, 0.5, 1), 150), kTangents + kPi / 2, 1e-12);
  EXPECT_NEAR(unit_length(kCylinder, around(255, 0.5, 1), 150), kTangents + kPi / 2, 1e-12);
  EXPECT_EQ(unit_length(kSphere, around(255, 0.5, 0.5), 150), 0);
  EXPECT_EQ(unit_length(kCylinder, around(255, 0.5, 0.5), 150), 0);
}

TEST(Wrap, ASideInsideDrawsThePathToTheSurface) {
  for (const Wrap::Shape shape : {kSphere, kCylinder}) {
    const std::optional<Arc> arc = wrap_around(shape, 1, Vector3d(0.1, 0, 0), around(0, 2), around(90, 2));
    ASSERT_TRUE(arc);
    EXPECT_EQ(arc->length, 0);
    EXPECT_LT((arc->from - around(45, 1)).norm(), 1e-9);
    EXPECT_LT((arc->to - around(45, 1)).norm(), 1e-9);
  }
}

// MuJoCo's solver gives up where the path misses the surface by a hair, and so must we to have its lengths.
TEST(Wrap, APathThatGrazesItsInsideTouchesBelowItsMiddle) {
  const double tangent = (std::acos(0.5) + std::acos(0.125)) * 180 / kPi;  // degrees between the ends
  const Vector3d start = around(0, 2), end = around(tangent - 0.02, 8);
  const std::optional<Arc> grazing = wrap_around(kCylinder, 1, Vector3d::Zero(), start, end);
  ASSERT_TRUE(grazing);
  EXPECT_LT((grazing->from - (start + end).normalized()).norm(), 1e-12);
  const std::optional<Arc> clear = wrap_around(kCylinder, 1, Vector3d::Zero(), start, around(tangent - 0.2, 8));
  ASSERT_TRUE(clear);
  EXPECT_LT((clear->from - around(60, 1)).norm(), 2e-3) << "near where the tangent touches";
}

// Then any plane through them will do for a sphere: that of the side.
TEST(Wrap, EndsOnALineThroughTheCentreBendAroundIt) {
  for (const Wrap::Shape shape : {kSphere, kCylinder}) {
    EXPECT_NEAR(unit_length(shape, std::nullopt, 180), kTangents + kPi / 3, 1e-7);
  }
  const std::optional<Arc> arc = wrap_around(kSphere, 1, Vector3d(0, 0, 3), Vector3d(2, 0, 0), Vector3d(-2, 0, 0));
  ASSERT_TRUE(arc);
  EXPECT_LT((arc->from - Vector3d(0.5, 0, std::numbers::sqrt3 / 2)).norm(), 1e-12);
  EXPECT_LT((arc->to - Vector3d(-0.5, 0, std::numbers::sqrt3 / 2)).norm(), 1e-12);
}

TEST(Wrap, OnACylinderHeightGrowsEvenlyAlongThePath) {
  const Vector3d start = around(0, 2), end = around(150, 2, 0.7);
  const double flat = kTangents + kPi / 6;
  const std::optional<Arc> arc = wrap_around(kCylinder, 1, std::nullopt, start, end);
  ASSERT_TRUE(arc);
  EXPECT_NEAR(bent_length(arc, start, end), std::hypot(flat, 0.7), 1e-12);
  EXPECT_NEAR(arc->from.z(), 0.7 * std::numbers::sqrt3 / flat, 1e-12);
}

TEST(Wrap, EndsInsideStayStraightAndEndsOnTheSurfaceCount) {
  for (const Wrap::Shape shape : {kSphere, kCylinder}) {
    for (const Side& side : {Side(), Side(around(255, 3)), Side(Vector3d(0.1, 0, 0))}) {
      EXPECT_FALSE(wrap_around(shape, 1, side, around(0, 0.9), around(150, 2)));
      EXPECT_FALSE(wrap_around(shape, 1, side, around(0, 2), Vector3d::Zero()));
    }
  }
  // On the surface but for rounding, which a square root of the distance to it would not survive.
  const Vector3d start(0.06, 0.08, 0), end(-0.2, 0, 0);
  const double angle = kPi - std::atan2(0.08, 0.06) - kPi / 3;
  EXPECT_NEAR(bent_length(wrap_around(kCylinder, 0.1, std::nullopt, start, end), start, end),
              0.1 * (angle + std::numbers::sqrt3), 1e-7);
}

}  // namespace
}  // namespace bodyopt::trainer::muscle_models
