#include "viewport/state/orbit_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "runtime/core/error.h"

namespace bodyopt::viewport {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kShallowest = 0.1;  // metres, of the target of a camera that looks elsewhere
static_assert(shots::OrbitView().vertical_angle == double{draw::kVerticalAngle});

// From the target towards the eye, unit.
Vec3 direction(const shots::OrbitView& view) {
  return {std::cos(view.elevation) * std::sin(view.azimuth), std::sin(view.elevation),
          std::cos(view.elevation) * std::cos(view.azimuth)};
}

double height_at_target(const shots::OrbitView& view) {
  return 2 * view.distance * std::tan(0.5 * view.vertical_angle);
}

// Upright but for the roll. By the poles, too: right is the turntable's side.
draw::ViewAxes axes_of(const shots::OrbitView& view) {
  const Vec3 back = direction(view), right{std::cos(view.azimuth), 0, -std::sin(view.azimuth)}, up = cross(back, right);
  const double c = std::cos(view.roll), s = std::sin(view.roll);
  return {c * right + s * up, c * up - s * right, back};
}

// The points moved along `back` into the plane of the origin: without depth, both kinds of camera see the same.
std::vector<float> without_depth(std::span<const float> points, const Vec3& back) {
  std::vector<float> flat(points.begin(), points.end());
  for (std::size_t at = 0; at + 2 < flat.size(); at += 3) {
    const Vec3 point{flat[at], flat[at + 1], flat[at + 2]};
    const std::array<float, 3> moved = draw::to_float(point - dot(point, back) * back);
    std::copy(moved.begin(), moved.end(), flat.begin() + static_cast<std::ptrdiff_t>(at));
  }
  return flat;
}

}  // namespace

OrbitCamera::OrbitCamera(const shots::OrbitView& view) : view_(view) {
  if (!std::isfinite(length(view.target) + view.distance + view.azimuth + view.elevation)) {
    throw Error(ErrorKind::usage, "a camera's target, distance, azimuth and elevation must be finite numbers");
  }
  view_.distance = std::clamp(view.distance, shots::OrbitView::kNearest, shots::OrbitView::kFarthest);
  view_.azimuth = std::remainder(view.azimuth, 2 * kPi);
  if (view.elevation > kSteepest) view_axis(AxisView::top);
  if (view.elevation < -kSteepest) view_axis(AxisView::bottom);
}

draw::Camera OrbitCamera::camera() const {
  draw::Camera camera;
  camera.eye = draw::to_float(view_.target + view_.distance * direction(view_));
  camera.target = draw::to_float(view_.target);
  camera.up = draw::to_float(axes_of(view_).up);
  camera.vertical_angle = static_cast<float>(view_.vertical_angle);
  if (view_.orthographic) camera.orthographic_height = static_cast<float>(height_at_target(view_));
  camera.cut_away = view_.cut_away;
  return camera;
}

void OrbitCamera::orbit(double right, double up) {
  view_.azimuth = std::remainder(view_.azimuth + right, 2 * kPi);
  view_.elevation = std::clamp(view_.elevation + up, -kSteepest, kSteepest);
}

void OrbitCamera::pan(double right, double down, double height) {
  if (!(height > 0)) return;
  const draw::ViewAxes axes = axes_of(view_);
  const double metres = height_at_target(view_) / height;  // a pixel
  view_.target = view_.target - right * metres * axes.right + down * metres * axes.up;
}

void OrbitCamera::dolly(double notches) {
  view_.distance =
      std::clamp(view_.distance * std::pow(0.9, notches), shots::OrbitView::kNearest, shots::OrbitView::kFarthest);
}

void OrbitCamera::frame(std::span<const float> points, float aspect, double share) {
  stand_upright();
  const Vec3 back = direction(view_);
  const draw::Camera seen = draw::frame_points(points, draw::to_float(back), aspect);
  view_.target = draw::to_double(seen.target);
  const double distance = draw::distance_to_target(
      view_.orthographic ? draw::frame_points(without_depth(points, back), draw::to_float(back), aspect) : seen);
  view_.distance = std::clamp(distance / share, shots::OrbitView::kNearest, shots::OrbitView::kFarthest);
}

void OrbitCamera::view_axis(AxisView axis) {
  struct Angles {
    double azimuth, elevation;
  };
  static constexpr Angles kAngles[] = {{0, 0},          {kPi, 0},       {0.5 * kPi, 0},
                                       {-0.5 * kPi, 0}, {0, 0.5 * kPi}, {0, -0.5 * kPi}};
  stand_upright();
  const Angles& angles = kAngles[static_cast<std::size_t>(axis)];
  view_.azimuth = angles.azimuth;
  view_.elevation = angles.elevation;
}

void OrbitCamera::stand_upright() {
  view_.roll = 0;
  view_.vertical_angle = shots::OrbitView().vertical_angle;
}

shots::OrbitView view_of(const ClipCamera& camera, std::size_t place) {
  const Affine& at = camera.places[std::min(place, camera.places.size() - 1)];
  const auto column = [&](std::size_t k) { return Vec3{at.m[0][k], at.m[1][k], at.m[2][k]}; };
  const double size = length(column(2));
  const Vec3 back = size > 0 ? (1 / size) * column(2) : Vec3{0, 0, 1}, eye = column(3);
  shots::OrbitView view;
  view.azimuth = std::atan2(back[0], back[2]);
  view.elevation = std::asin(std::clamp(back[1], -1.0, 1.0));
  const draw::ViewAxes upright = axes_of(view);
  view.roll = std::atan2(-dot(column(1), upright.right), dot(column(1), upright.up));
  view.distance = std::clamp(dot(eye, back), kShallowest, shots::OrbitView::kFarthest);
  view.orthographic = camera.vertical_angle == 0;
  if (view.orthographic) {
    view.distance = std::clamp(camera.height / height_at_target({.distance = 1}), shots::OrbitView::kNearest,
                               shots::OrbitView::kFarthest);
  } else {
    view.vertical_angle = camera.vertical_angle;
  }
  view.target = eye - view.distance * back;
  return view;
}

}  // namespace bodyopt::viewport
