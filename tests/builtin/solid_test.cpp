// Solids by signed distance, their first mesh, and remeshing.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <set>

#include "geometry/remesh.h"
#include "trainer/builtin/implicit.h"
#include "trainer/builtin/march.h"

namespace bodyopt {
namespace {

using Eigen::Vector3d;

RoundedPart ball(const Vector3d& centre, double radius) {
  return belly(centre, Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::Constant(radius), 0.01);
}

// A ring of eight straight limbs in the plane z = 0: one handle.
std::vector<RoundedPart> ring() {
  std::vector<RoundedPart> parts;
  for (int k = 0; k < 8; ++k) {
    const double a = k * M_PI / 4, b = (k + 1) * M_PI / 4;
    parts.push_back(
        limb({0.1 * std::cos(a), 0.1 * std::sin(a), 0}, {0.1 * std::cos(b), 0.1 * std::sin(b), 0}, 0.03, 0.03, 0.002));
  }
  return parts;
}

double volume(const Surface& surface) {
  double sum = 0;
  for (const auto& t : surface.triangles) {
    sum += surface.points[t[0]].dot(surface.points[t[1]].cross(surface.points[t[2]])) / 6;
  }
  return sum;
}

// Vertices - edges + faces of a closed surface; fails where an edge has not two triangles of opposite sense.
long euler_number(const Surface& surface) {
  std::set<std::pair<int, int>> edges;
  for (const auto& t : surface.triangles) {
    for (int k = 0; k < 3; ++k) EXPECT_TRUE(edges.insert({t[k], t[(k + 1) % 3]}).second);
  }
  for (const auto& [a, b] : edges) EXPECT_TRUE(edges.count({b, a}));
  return static_cast<long>(surface.points.size()) - static_cast<long>(edges.size() / 2) +
         static_cast<long>(surface.triangles.size());
}

TEST(Solid, DistancesOfBallAndConeAreExact) {
  const Solid one({ball({0.1, 0, 0}, 0.05)});
  EXPECT_NEAR(one.distance({0.1, 0.3, 0.4}), 0.45, 1e-12);
  EXPECT_NEAR(one.distance({0.12, 0, 0}), -0.03, 1e-12);
  // A cone touches all the balls it sweeps: the nearest of many balls is the distance.
  const Vector3d a(0, 0, 0), b(0.3, 0.1, 0);
  const Solid cone({limb(a, b, 0.08, 0.03, 0.01)});
  for (const Vector3d& p :
       {Vector3d(0.1, 0.2, 0.1), Vector3d(-0.2, 0, 0.1), Vector3d(0.5, 0.2, 0), Vector3d(0.2, 0.2, 0)}) {
    double nearest = 1;
    for (int k = 0; k <= 10000; ++k) {
      const double t = k / 10000.0;
      nearest = std::min(nearest, (p - a - t * (b - a)).norm() - (0.08 - 0.05 * t));
    }
    EXPECT_NEAR(cone.distance(p), nearest, 1e-7);
  }
}

TEST(Solid, FlattenedLimbHasTheHalfAxesAskedFor) {
  const Solid oval({limb({-1, 0, 0}, {1, 0, 0}, 0.10, 0.10, 0.01, Vector3d::UnitY(), 0.5)});
  EXPECT_NEAR(oval.distance({0, 0.05, 0}), 0, 1e-12);
  EXPECT_NEAR(oval.distance({0, 0, 0.10}), 0, 1e-12);
}

TEST(Solid, GradientIsTheSlopeOfTheDistanceOnTheSurface) {
  std::vector<RoundedPart> parts = ring();
  parts.push_back(belly({0.1, 0, 0.02}, {1, 1, 0}, {0, 0, 1}, {0.06, 0.02, 0.03}, 0.02));
  const Solid solid(parts);
  for (const Vector3d& start : {Vector3d(0.15, 0.02, 0.03), Vector3d(0, 0.14, 0.01), Vector3d(-0.1, 0.1, 0.05)}) {
    const Vector3d p = solid.project(start);
    EXPECT_NEAR(solid.distance(p), 0, 1e-6);
    const DistanceSample at = solid.sample(p);
    for (int k = 0; k < 3; ++k) {
      const Vector3d step = 1e-6 * Vector3d::Unit(k);
      EXPECT_NEAR((solid.distance(p + step) - solid.distance(p - step)) / 2e-6, at.gradient[k], 0.05);
    }
    EXPECT_NEAR(solid.distance(solid.project(start, 0.01)), -0.01, 1e-6);
  }
}

TEST(Solid, KeepInsideCutsWhatCameBefore) {
  RoundedPart cut = ball({0.1, 0, 0}, 0.1);
  cut.keep_inside = true;
  const Solid lens({ball({0, 0, 0}, 0.1), cut});
  EXPECT_LT(lens.distance({0.05, 0, 0}), 0);
  EXPECT_GT(lens.distance({-0.05, 0, 0}), 0.04);
}

TEST(Solid, GridChangesNothing) {
  const Solid plain(ring()), fast(ring(), {-0.2, -0.2, -0.1}, {0.2, 0.2, 0.1});
  for (int k = 0; k < 500; ++k) {
    const Vector3d p(0.3 * std::sin(k * 0.37), 0.25 * std::sin(k * 0.73), 0.15 * std::sin(k * 1.13));
    EXPECT_NEAR(fast.distance(p), plain.distance(p), 1e-12);
  }
}

TEST(March, MakesAClosedBallAndARingWithOneHandle) {
  const Vector3d low(-0.2, -0.2, -0.2), high(0.2, 0.2, 0.2);
  const Surface round = march(Solid({ball({0, 0, 0}, 0.1)}), low, high, 0.01, 0);
  EXPECT_EQ(euler_number(round), 2);
  EXPECT_NEAR(volume(round), 4.0 / 3 * M_PI * 1e-3, 4e-5);
  const Surface smaller = march(Solid({ball({0, 0, 0}, 0.1)}), low, high, 0.01, 0.02);
  EXPECT_NEAR(volume(smaller), 4.0 / 3 * M_PI * 0.512e-3, 3e-5);
  EXPECT_EQ(euler_number(march(Solid(ring()), low, high, 0.01, 0)), 0);
}

TEST(Remesh, GivesEvenTrianglesAndKeepsTheHandle) {
  const Solid solid(ring());
  const auto size = [](const Vector3d& p) { return p.x() < 0 ? 0.012 : 0.018; };
  const Surface rough = march(solid, {-0.2, -0.2, -0.2}, {0.2, 0.2, 0.2}, 0.01, 0.002);
  const Surface even = remesh(
      rough, [&](const Eigen::Vector3d& p) { return solid.project(p); }, size, 6);
  EXPECT_EQ(euler_number(even), 0);
  for (const Vector3d& p : even.points) EXPECT_NEAR(solid.distance(p), 0, 1e-6);
  double left = 0, right = 0;
  int left_count = 0, right_count = 0;
  for (const auto& t : even.triangles) {
    for (int k = 0; k < 3; ++k) {
      const Vector3d &a = even.points[t[k]], &b = even.points[t[(k + 1) % 3]], &c = even.points[t[(k + 2) % 3]];
      EXPECT_GT(std::atan2((b - a).cross(c - a).norm(), (b - a).dot(c - a)) * 180 / M_PI, 22);
      if (a.x() < -0.02) left += (a - b).norm(), ++left_count;
      if (a.x() > 0.02) right += (a - b).norm(), ++right_count;
    }
  }
  EXPECT_NEAR(left / left_count, 0.012, 0.0015);
  EXPECT_NEAR(right / right_count, 0.018, 0.0025);
}

}  // namespace
}  // namespace bodyopt
