#include "proxy_viewer/state/orbit_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

constexpr double kPi = std::numbers::pi;

// From the target towards the eye, unit.
Vec3 direction(const OrbitView& view) {
  return {std::cos(view.elevation) * std::sin(view.azimuth), std::sin(view.elevation),
          std::cos(view.elevation) * std::cos(view.azimuth)};
}

double height_at_target(const OrbitView& view) {
  return 2 * view.distance * std::tan(0.5 * static_cast<double>(kVerticalAngle));
}

// The points moved along `back` into the plane of the origin: without depth, both kinds of camera see the same.
std::vector<float> without_depth(std::span<const float> points, const Vec3& back) {
  std::vector<float> flat(points.begin(), points.end());
  for (std::size_t at = 0; at + 2 < flat.size(); at += 3) {
    const Vec3 point{flat[at], flat[at + 1], flat[at + 2]};
    const std::array<float, 3> moved = to_float(point - dot(point, back) * back);
    std::copy(moved.begin(), moved.end(), flat.begin() + static_cast<std::ptrdiff_t>(at));
  }
  return flat;
}

}  // namespace

OrbitCamera::OrbitCamera(const OrbitView& view) : view_(view) {
  if (!std::isfinite(length(view.target) + view.distance + view.azimuth + view.elevation)) {
    throw Error(ErrorKind::usage, "a camera's target, distance, azimuth and elevation must be finite numbers");
  }
  view_.distance = std::clamp(view.distance, OrbitView::kNearest, OrbitView::kFarthest);
  view_.azimuth = std::remainder(view.azimuth, 2 * kPi);
  if (view.elevation > kSteepest) view_axis(AxisView::top);
  if (view.elevation < -kSteepest) view_axis(AxisView::bottom);
}

Camera OrbitCamera::camera() const {
  Camera camera;
  camera.eye = to_float(view_.target + view_.distance * direction(view_));
  camera.target = to_float(view_.target);
  camera.vertical_angle = kVerticalAngle;
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
  const ViewAxes axes = view_axes(direction(view_));
  const double metres = height_at_target(view_) / height;  // a pixel
  view_.target = view_.target - right * metres * axes.right + down * metres * axes.up;
}

void OrbitCamera::dolly(double notches) {
  view_.distance = std::clamp(view_.distance * std::pow(0.9, notches), OrbitView::kNearest, OrbitView::kFarthest);
}

void OrbitCamera::frame(std::span<const float> points, float aspect, double share) {
  const Vec3 back = direction(view_);
  const Camera seen = frame_points(points, to_float(back), aspect);
  view_.target = to_double(seen.target);
  const double distance =
      distance_to_target(view_.orthographic ? frame_points(without_depth(points, back), to_float(back), aspect) : seen);
  view_.distance = std::clamp(distance / share, OrbitView::kNearest, OrbitView::kFarthest);
}

void OrbitCamera::view_axis(AxisView axis) {
  struct Angles {
    double azimuth, elevation;
  };
  static constexpr Angles kAngles[] = {{0, 0},          {kPi, 0},       {0.5 * kPi, 0},
                                       {-0.5 * kPi, 0}, {0, 0.5 * kPi}, {0, -0.5 * kPi}};
  const Angles& angles = kAngles[static_cast<std::size_t>(axis)];
  view_.azimuth = angles.azimuth;
  view_.elevation = angles.elevation;
}

}  // namespace bodyopt
