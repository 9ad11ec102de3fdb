#include "geometry/surface_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/geometry/sheet.h"

namespace bodyopt {
namespace {

// Straight lines, whichever way the triangles lie.
TEST(SurfaceDistance, InAPlaneIsThatThroughTheAir) {
  Sheet sheet = flat_sheet(25);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-0.3, 0.3);
  for (Eigen::Index v = 0; v < sheet.vertices.rows(); ++v) {
    const bool inner = sheet.vertices.row(v).head<2>().cwiseAbs().maxCoeff() < 0.99;
    if (inner) sheet.vertices.row(v) += Eigen::RowVector3d(uniform(random), uniform(random), 0) * sheet.edge;
  }
  const SurfaceDistance paths(sheet.vertices.rows(), sheet.triangles);
  for (const Eigen::Index t : {100, 577, 801}) {
    const SkinPoint from = point_of(sheet, t, {0.2, 0.5, 0.3});
    const auto places = paths.around(sheet.vertices, from, 0.7);
    std::size_t within = 0;
    for (Eigen::Index v = 0; v < sheet.vertices.rows(); ++v) {
      if ((sheet.vertices.row(v).transpose() - from.position).norm() <= 0.7) ++within;
    }
    EXPECT_EQ(places.size(), within);
    for (const SurfacePlace& place : places) {
      const double straight = (sheet.vertices.row(place.vertex).transpose() - from.position).norm();
      const bool at_the_rim = straight > 0.7 - 2 * sheet.edge;
      EXPECT_NEAR(place.distance, straight, at_the_rim ? 0.005 : 1e-9);
    }
  }
}

// Rolled up into a tube that does not close it keeps its distances, to the error of its facets.
TEST(SurfaceDistance, OnARolledSheetIsThatBeforeItWasRolled) {
  const Sheet flat = flat_sheet(41);
  Sheet rolled = flat;
  const double radius = 0.35;  // 5.7 of 6.28 radians around
  for (Eigen::Index v = 0; v < flat.vertices.rows(); ++v) {
    const double angle = flat.vertices(v, 0) / radius;
    rolled.vertices.row(v) << radius * std::sin(angle), flat.vertices(v, 1), radius * std::cos(angle);
  }
  const SurfaceDistance paths(rolled.vertices.rows(), rolled.triangles);
  const SkinPoint from = point_of(rolled, 80, {1, 0, 0}), on_flat = point_of(flat, 80, {1, 0, 0});
  const auto places = paths.around(rolled.vertices, from, 1.5);
  ASSERT_GT(places.size(), 400u);
  for (const SurfacePlace& place : places) {
    const double straight = (flat.vertices.row(place.vertex).transpose() - on_flat.position).norm();
    EXPECT_NEAR(place.distance, straight, 0.005 * straight + 1e-12);
  }
}

TEST(SurfaceDistance, WhatIsNotJoinedIsNeverReached) {
  const Sheet sheet = flat_sheet(5);
  Positions two(50, 3);
  two << sheet.vertices, sheet.vertices.rowwise() + Eigen::RowVector3d(0, 0, 0.01);
  Triangles both(2 * sheet.triangles.rows(), 3);
  both << sheet.triangles, (sheet.triangles.array() + 25u).matrix();
  const SurfaceDistance paths(50, both);
  const auto places = paths.around(two, point_of(sheet, 3, {0.3, 0.3, 0.4}), 100);
  EXPECT_EQ(places.size(), 25u);
  for (const SurfacePlace& place : places) EXPECT_LT(place.vertex, 25u);
}

}  // namespace
}  // namespace bodyopt
