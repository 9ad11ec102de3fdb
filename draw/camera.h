// Cameras. Their frame: x to the right, y up, z from the scene towards the camera.
#pragma once

#include <array>
#include <span>

#include "runtime/core/transform.h"

namespace bodyopt::draw {

constexpr float kVerticalAngle = 0.45f;  // about the 50 mm lens of a portrait: little perspective distortion
constexpr float kMaxCoordinate = 1e9f;   // metres; beyond it single precision overflows on the way to the screen

inline Vec3 to_double(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

inline std::array<float, 3> to_float(const Vec3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

struct Camera {
  std::array<float, 3> eye{}, target{};  // metres, world
  float vertical_angle = 0.5f;           // radians
  float orthographic_height = 0;         // metres seen vertically, whatever the distance; 0: perspective
  bool cut_away = false;                 // what stands before the target is cut away
  std::array<float, 3> up{};             // that points up in the picture, world; none: as view_axes() of the direction
};

// Returns the camera that sees all points (V x 3, world, at least one) as large as it can. `direction`: world, towards
// the camera; `aspect`: width over height. Throws Error(usage).
Camera frame_points(std::span<const float> points, const std::array<float, 3>& direction, float aspect);

// Frames the corners of the box [low, high] in the same way.
Camera frame_box(const std::array<float, 3>& low, const std::array<float, 3>& high,
                 const std::array<float, 3>& direction, float aspect);

struct ViewAxes {
  Vec3 right, up, back;  // orthonormal, world
};

// Axes of a camera that looks against `direction` (world, towards the camera): upright, whatever the direction.
ViewAxes view_axes(const Vec3& direction);
ViewAxes view_axes(const Camera& camera);

// World to camera space, rows of a 3 x 4 matrix. Throws Error(usage) beyond kMaxCoordinate, or not finite.
std::array<std::array<float, 4>, 3> view_matrix(const Camera& camera);

struct DepthRange {
  double nearest = 1e30, farthest = -1e30;  // metres before the camera
};

// From the eye to the target, metres.
double distance_to_target(const Camera& camera);

// Returns x and y scale, and depth terms a, b. Depth is (z a + b) / w with w = -z, or 1 of an orthographic camera. Near
// and far planes fit tightly around what is seen, so that depth is exact for a house. An orthographic camera sees
// behind its eye; one that cuts away begins at its target. `aspect`: width over height.
std::array<float, 4> projection(const Camera& camera, const DepthRange& seen, double aspect);

}  // namespace bodyopt::draw
