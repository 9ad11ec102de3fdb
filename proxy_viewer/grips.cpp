#include "proxy_viewer/grips.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "draw/camera.h"
#include "proxy_viewer/picking.h"
#include "proxy_viewer/scene/turn_rings.h"

namespace bodyopt {
namespace {

constexpr double kGripped = 6;  // pixels

double apart(const std::optional<std::array<double, 2>>& pixel, float x, float y) {
  return pixel ? std::hypot((*pixel)[0] - static_cast<double>(x), (*pixel)[1] - static_cast<double>(y)) : 1e9;
}

// Of a pixel around the middle, to the left about, as seen.
double angle_around(const std::array<double, 2>& middle, const std::array<float, 2>& pixel) {
  return std::atan2(middle[1] - static_cast<double>(pixel[1]), static_cast<double>(pixel[0]) - middle[0]);
}

void turn_ring(const Scene& scene, const Rectangle& picture, const TurnRing& ring, const std::array<float, 2>& from,
               const std::array<float, 2>& to, Controls& controls) {
  const auto middle = pixel_of(scene, controls, picture, from[0], ring.centre);
  if (!middle) return;
  const double by = std::remainder(angle_around(*middle, to) - angle_around(*middle, from), 2 * std::numbers::pi);
  const Camera camera = controls.camera.camera();
  const bool is_towards = dot(ring.along, to_double(camera.eye) - ring.centre) > 0;
  const double turned = ring.angle + (is_towards ? 1 : -1) * by * 180 / std::numbers::pi;
  controls.settings.pose.joints[controls.joint][ring.axis] =
      std::clamp(turned, ring.low, std::max(ring.low, ring.high));
}

void move_pin(const Scene& scene, const Rectangle& picture, const std::array<float, 2>& to, Controls& controls) {
  Vec3& pin = controls.settings.pose.pins.at(controls.joint);
  const Camera camera = controls.camera.camera();
  const Vec3 towards = to_double(camera.eye) - to_double(camera.target);
  const Ray ray = ray_through(camera, view_at(scene, controls, picture, to[0]), static_cast<double>(to[0]),
                              static_cast<double>(to[1]));
  const double slope = dot(ray.along, towards);
  if (slope == 0) return;
  pin = ray.from + (dot(pin - ray.from, towards) / slope) * ray.along;
}

}  // namespace

std::optional<Grip> grip_at(const Scene& scene, const Controls& controls, const Rectangle& picture, float x, float y) {
  if (!controls.settings.look.skeleton || controls.joint.empty()) return std::nullopt;
  const auto pin = controls.settings.pose.pins.find(controls.joint);
  if (pin != controls.settings.pose.pins.end() &&
      apart(pixel_of(scene, controls, picture, x, pin->second), x, y) < 2 * kGripped) {
    return Grip{};
  }
  std::optional<Grip> grip;
  double nearest = kGripped;
  for (const TurnRing& ring : turn_rings(scene, controls)) {
    if (ring.low >= ring.high) continue;
    for (int degrees = 0; degrees < 360; degrees += 5) {
      const double away = apart(pixel_of(scene, controls, picture, x, ring.point(degrees)), x, y);
      if (away >= nearest) continue;
      nearest = away;
      grip = Grip{ring.axis};
    }
  }
  return grip;
}

void drag_grip(const Scene& scene, const Rectangle& picture, const std::array<float, 2>& from,
               const std::array<float, 2>& to, Controls& controls) {
  if (!controls.grip->ring) {
    if (controls.settings.pose.pins.contains(controls.joint)) move_pin(scene, picture, to, controls);
    return;
  }
  const std::vector<TurnRing> rings = turn_rings(scene, controls);
  if (rings.empty()) return;
  turn_ring(scene, picture, rings[*controls.grip->ring], from, to, controls);
}

}  // namespace bodyopt
