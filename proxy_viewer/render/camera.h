// The camera's frame: x to the right, y up, z from the scene towards the camera.
#pragma once

#include <array>

#include "proxy_viewer/render/renderer.h"

namespace bodyopt {

constexpr float kMaxCoordinate = 1e9f;  // metres; beyond it single precision overflows on the way to the screen

using Vector3 = std::array<double, 3>;

inline double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

struct ViewAxes {
  Vector3 right, up, back;  // orthonormal, world
};

// Axes of a camera that looks against `direction` (world, towards the camera): upright, whatever the direction.
ViewAxes view_axes(const Vector3& direction);

// World to camera space, rows of a 3 x 4 matrix. Throws Error(usage) for a camera that is not finite or beyond
// kMaxCoordinate.
std::array<std::array<float, 4>, 3> view_matrix(const Camera& camera);

}  // namespace bodyopt
