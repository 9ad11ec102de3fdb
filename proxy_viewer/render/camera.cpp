#include "proxy_viewer/render/camera.h"

#include <algorithm>
#include <cmath>

#include "runtime/basis/error.h"

namespace bodyopt {
namespace {

constexpr float kVerticalAngle = 0.45f;  // about the 50 mm lens of a portrait: little perspective distortion
constexpr double kMargin = 1.08;         // of the box's extent

Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Vector3 normalised(const Vector3& v, const Vector3& otherwise) {
  const double length = std::sqrt(dot(v, v));
  if (!std::isfinite(length) || length < 1e-12) return otherwise;
  return {v[0] / length, v[1] / length, v[2] / length};
}

Vector3 to_double(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

std::array<float, 3> to_float(const Vector3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

bool all_in_range(const std::array<float, 3>& v) {
  return std::all_of(v.begin(), v.end(), [](float x) { return std::abs(x) <= kMaxCoordinate; });
}

}  // namespace

ViewAxes view_axes(const Vector3& direction) {
  ViewAxes axes;
  axes.back = normalised(direction, {0, 0, 1});
  const Vector3 above = std::abs(axes.back[1]) > 0.999 ? Vector3{0, 0, -1} : Vector3{0, 1, 0};
  axes.right = normalised(cross(above, axes.back), {1, 0, 0});
  axes.up = cross(axes.back, axes.right);
  return axes;
}

std::array<std::array<float, 4>, 3> view_matrix(const Camera& camera) {
  if (!all_in_range(camera.eye) || !all_in_range(camera.target) || !(camera.vertical_angle > 0) ||
      !(camera.vertical_angle < 3.1f)) {
    throw Error(ErrorKind::usage,
                "a camera must have a finite eye and target and a vertical angle between 0 and 3.1 radians");
  }
  const Vector3 eye = to_double(camera.eye), target = to_double(camera.target);
  const ViewAxes axes = view_axes({eye[0] - target[0], eye[1] - target[1], eye[2] - target[2]});
  std::array<std::array<float, 4>, 3> rows;
  const Vector3* const all[3] = {&axes.right, &axes.up, &axes.back};
  for (std::size_t r = 0; r < 3; ++r) {
    const Vector3& axis = *all[r];
    const std::array<float, 3> xyz = to_float(axis);
    rows[r] = {xyz[0], xyz[1], xyz[2], static_cast<float>(-dot(axis, eye))};
  }
  return rows;
}

Camera frame_box(const std::array<float, 3>& low, const std::array<float, 3>& high,
                 const std::array<float, 3>& direction, float aspect) {
  if (!all_in_range(low) || !all_in_range(high) || !(aspect > 0) || !std::isfinite(aspect)) {
    throw Error(ErrorKind::usage, "a box to frame must be finite and the aspect ratio positive");
  }
  const Vector3 a = to_double(low), b = to_double(high);
  const Vector3 centre = {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
  const ViewAxes axes = view_axes(to_double(direction));
  const double tan_y = std::tan(kVerticalAngle / 2.0), tan_x = tan_y * static_cast<double>(aspect);
  // A corner at (x, y, z) of the camera's frame about the centre is seen from a distance of z + |x| / tan_x or more.
  double distance = 1e-3;
  for (unsigned corner = 0; corner < 8; ++corner) {
    Vector3 offset;
    for (unsigned i = 0; i < 3; ++i) offset[i] = (corner >> i & 1 ? b[i] : a[i]) - centre[i];
    const double x = std::abs(dot(axes.right, offset)), y = std::abs(dot(axes.up, offset));
    distance = std::max(distance, dot(axes.back, offset) + kMargin * std::max(x / tan_x, y / tan_y));
  }
  Camera camera;
  camera.vertical_angle = kVerticalAngle;
  camera.target = to_float(centre);
  for (std::size_t i = 0; i < 3; ++i) camera.eye[i] = static_cast<float>(centre[i] + distance * axes.back[i]);
  return camera;
}

}  // namespace bodyopt
