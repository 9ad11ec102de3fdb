#include "viewport/state/orbit_camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "draw/camera.h"
#include "runtime/core/error.h"

namespace bodyopt::testing {
namespace orbit_camera_test {

using namespace shots;
using namespace draw;
using namespace viewport;

constexpr double kPi = std::numbers::pi;
constexpr double kHeight = 600;  // pixels of the picture
constexpr float kAspect = 1.5f;

// Where a point is seen: metres right and up of the middle, of a picture that is two high.
std::array<double, 2> seen(const Camera& camera, const Vec3& point) {
  const auto view = view_matrix(camera);
  std::array<double, 3> p{};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t i = 0; i < 3; ++i) p[r] += static_cast<double>(view[r][i]) * point[i];
    p[r] += static_cast<double>(view[r][3]);
  }
  const double scale = camera.orthographic_height > 0
                           ? 2 / static_cast<double>(camera.orthographic_height)
                           : 1 / (-p[2] * std::tan(0.5 * static_cast<double>(camera.vertical_angle)));
  return {scale * p[0], scale * p[1]};
}

Vec3 eye(const OrbitCamera& camera) {
  const Camera c = camera.camera();
  return {c.eye[0], c.eye[1], c.eye[2]};
}

ViewAxes axes(const OrbitCamera& camera) { return view_axes(eye(camera) - camera.view().target); }

OrbitView some_view() {
  return {.target = {0.3, 1.1, -0.2}, .distance = 2.5, .azimuth = 0.7, .elevation = 0.4, .orthographic = false};
}

TEST(OrbitCamera, OrbitsAroundTheTargetWithoutRoll) {
  OrbitCamera camera(some_view());
  std::mt19937 random(3);
  std::uniform_real_distribution<double> drag(-1, 1);
  for (int k = 0; k < 200; ++k) {
    camera.orbit(drag(random), drag(random));
    EXPECT_NEAR(length(eye(camera) - camera.view().target), 2.5, 1e-6);
    EXPECT_NEAR(axes(camera).right[1], 0, 1e-6);  // the horizon is level
    EXPECT_GT(axes(camera).up[1], 0);             // and above is up
  }
  EXPECT_EQ(camera.view().target, some_view().target);
}

TEST(OrbitCamera, TheEyeGoesRightAndUp) {
  OrbitCamera camera;
  camera.orbit(0.1, 0);
  EXPECT_GT(eye(camera)[0], 0.1);
  camera.orbit(0, 0.1);
  EXPECT_GT(eye(camera)[1], 0.1);
}

TEST(OrbitCamera, StopsBeforeThePole) {
  OrbitCamera camera;
  camera.orbit(0.8, 100);
  const Vec3 right = axes(camera).right;
  EXPECT_NEAR(right[0], std::cos(0.8), 1e-5);  // still the turntable's side, not the one chosen at the pole
  EXPECT_NEAR(right[2], -std::sin(0.8), 1e-5);
  camera.orbit(0, -100);
  EXPECT_LT(eye(camera)[1], -2.9);
  EXPECT_NEAR(axes(camera).right[0], std::cos(0.8), 1e-5);
}

TEST(OrbitCamera, WhatIsAsDeepAsTheTargetFollowsTheCursor) {
  for (const bool orthographic : {false, true}) {
    OrbitView view = some_view();
    view.orthographic = orthographic;
    OrbitCamera camera(view);
    const ViewAxes a = axes(camera);
    const Vec3 point = view.target + 0.2 * a.right - 0.1 * a.up;
    const auto before = seen(camera.camera(), point);
    camera.pan(37, -21, kHeight);
    const auto after = seen(camera.camera(), point);
    EXPECT_NEAR((after[0] - before[0]) * 0.5 * kHeight, 37, 1e-3) << orthographic;
    EXPECT_NEAR((after[1] - before[1]) * 0.5 * kHeight, 21, 1e-3) << orthographic;
    EXPECT_NEAR(dot(camera.view().target - view.target, a.back), 0, 1e-9);
  }
}

TEST(OrbitCamera, AWindowWithoutAPictureDoesNotPan) {
  OrbitCamera camera(some_view());
  camera.pan(10, 10, 0);
  EXPECT_EQ(camera.view(), some_view());
}

TEST(OrbitCamera, DolliesByAShareOfTheDistance) {
  OrbitCamera camera(some_view());
  camera.dolly(1);
  EXPECT_NEAR(camera.view().distance, 2.25, 1e-12);
  camera.dolly(-1);
  EXPECT_NEAR(camera.view().distance, 2.5, 1e-12);
  EXPECT_EQ(camera.view().target, some_view().target);
  camera.dolly(1e4);
  EXPECT_EQ(camera.view().distance, OrbitView::kNearest);
  camera.dolly(-1e4);
  EXPECT_EQ(camera.view().distance, OrbitView::kFarthest);
}

TEST(OrbitCamera, OrthographicKeepsTheSizeAtTheTarget) {
  OrbitCamera camera(some_view());
  camera.orbit(0.3, -0.2);
  const Vec3 point = camera.view().target + 0.4 * axes(camera).right + 0.3 * axes(camera).up;
  const auto perspective = seen(camera.camera(), point);
  camera.toggle_orthographic();
  EXPECT_GT(camera.camera().orthographic_height, 0);
  const auto orthographic = seen(camera.camera(), point);
  EXPECT_NEAR(orthographic[0], perspective[0], 1e-6);
  EXPECT_NEAR(orthographic[1], perspective[1], 1e-6);
  camera.toggle_orthographic();
  EXPECT_EQ(camera.camera().orthographic_height, 0);
}

TEST(OrbitCamera, FramesAllPointsAsLargeAsCanBe) {
  // Wide at the back and pointed at the front: perspective and orthographic cameras frame it differently.
  std::vector<float> points{0, 0, 1};
  for (const float x : {-1.0f, 1.0f}) {
    for (const float y : {-1.0f, 1.0f}) points.insert(points.end(), {x, y, -1});
  }
  for (const bool orthographic : {false, true}) {
    for (const double azimuth : {0.0, 0.5, kPi, -2.0}) {
      OrbitCamera camera({.azimuth = azimuth, .elevation = 0.2, .orthographic = orthographic});
      camera.frame(points, kAspect);
      EXPECT_EQ(camera.view().azimuth, std::remainder(azimuth, 2 * kPi));
      double widest = 0;
      for (std::size_t at = 0; at < points.size(); at += 3) {
        const auto p = seen(camera.camera(), {points[at], points[at + 1], points[at + 2]});
        widest = std::max({widest, std::abs(p[0]) / static_cast<double>(kAspect), std::abs(p[1])});
      }
      EXPECT_LT(widest, 1) << orthographic << " " << azimuth;
      EXPECT_GT(widest, 0.85) << orthographic << " " << azimuth;
    }
  }
}

TEST(OrbitCamera, AxisViewsLookAlongTheAxes) {
  OrbitCamera camera(some_view());
  const auto expect = [&](AxisView axis, const Vec3& back, const Vec3& up) {
    camera.view_axis(axis);
    const ViewAxes a = axes(camera);
    EXPECT_NEAR(length(a.back - back), 0, 1e-6);
    EXPECT_NEAR(length(a.up - up), 0, 1e-6);
    EXPECT_NEAR(length(eye(camera) - camera.view().target), 2.5, 1e-6);
  };
  expect(AxisView::front, {0, 0, 1}, {0, 1, 0});
  expect(AxisView::back, {0, 0, -1}, {0, 1, 0});
  expect(AxisView::right, {1, 0, 0}, {0, 1, 0});
  expect(AxisView::left, {-1, 0, 0}, {0, 1, 0});
  expect(AxisView::top, {0, 1, 0}, {0, 0, -1});
  camera.orbit(0, 0);  // leaving the pole, right stays right
  EXPECT_NEAR(axes(camera).right[0], 1, 1e-6);
  expect(AxisView::bottom, {0, -1, 0}, {0, 0, 1});
  camera.orbit(0, 0);
  EXPECT_NEAR(axes(camera).right[0], 1, 1e-6);
}

TEST(OrbitCamera, TakesViewsFromOutsideWithinItsLimits) {
  const OrbitCamera camera({.distance = 1e9, .azimuth = 9 * kPi});
  EXPECT_EQ(camera.view().distance, OrbitView::kFarthest);
  EXPECT_NEAR(std::abs(camera.view().azimuth), kPi, 1e-9);
  OrbitCamera seen_from(some_view());
  for (const AxisView axis : {AxisView::back, AxisView::left, AxisView::top, AxisView::bottom}) {
    seen_from.view_axis(axis);
    EXPECT_EQ(OrbitCamera(seen_from.view()).view(), seen_from.view());
  }
  // By the poles: from the top and the bottom.
  for (const double elevation : {1.55, 7.0, -1.55, -7.0}) {
    const OrbitView view = OrbitCamera({.azimuth = 0.7, .elevation = elevation}).view();
    EXPECT_EQ(view.azimuth, 0);
    EXPECT_EQ(view.elevation, std::copysign(0.5 * kPi, elevation));
  }
  for (const double wrong : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(OrbitCamera({.target = {0, wrong, 0}}), Error);
    EXPECT_THROW(OrbitCamera({.distance = wrong}), Error);
    EXPECT_THROW(OrbitCamera({.elevation = wrong}), Error);
  }
}

}  // namespace orbit_camera_test
}  // namespace bodyopt::testing
