#include "proxy_viewer/render/camera.h"

#include <algorithm>
#include <cmath>

#include "runtime/basis/error.h"

namespace bodyopt {
namespace {

constexpr float kVerticalAngle = 0.45f;  // about the 50 mm lens of a portrait: little perspective distortion
constexpr double kMargin = 1.08;         // of the box's extent

Vec3 normalised(const Vec3& v, const Vec3& otherwise) {
  const double size = length(v);
  return std::isfinite(size) && size > 1e-12 ? (1 / size) * v : otherwise;
}

Vec3 to_double(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

std::array<float, 3> to_float(const Vec3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

bool all_in_range(const std::array<float, 3>& v) {
  return std::all_of(v.begin(), v.end(), [](float x) { return std::abs(x) <= kMaxCoordinate; });
}

}  // namespace

ViewAxes view_axes(const Vec3& direction) {
  ViewAxes axes;
  axes.back = normalised(direction, {0, 0, 1});
  const Vec3 above = std::abs(axes.back[1]) > 0.999 ? Vec3{0, 0, -1} : Vec3{0, 1, 0};
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
  const Vec3 eye = to_double(camera.eye), target = to_double(camera.target);
  const ViewAxes axes = view_axes(eye - target);
  std::array<std::array<float, 4>, 3> rows;
  const Vec3* const all[3] = {&axes.right, &axes.up, &axes.back};
  for (std::size_t r = 0; r < 3; ++r) {
    const Vec3& axis = *all[r];
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
  const Vec3 a = to_double(low), b = to_double(high);
  const Vec3 centre = 0.5 * (a + b);
  const ViewAxes axes = view_axes(to_double(direction));
  const double tan_y = std::tan(kVerticalAngle / 2.0), tan_x = tan_y * static_cast<double>(aspect);
  // A corner at (x, y, z) of the camera's frame about the centre is seen from a distance of z + |x| / tan_x or more.
  double distance = 1e-3;
  for (unsigned corner = 0; corner < 8; ++corner) {
    Vec3 offset;
    for (unsigned i = 0; i < 3; ++i) offset[i] = (corner >> i & 1 ? b[i] : a[i]) - centre[i];
    const double x = std::abs(dot(axes.right, offset)), y = std::abs(dot(axes.up, offset));
    distance = std::max(distance, dot(axes.back, offset) + kMargin * std::max(x / tan_x, y / tan_y));
  }
  Camera camera;
  camera.vertical_angle = kVerticalAngle;
  camera.target = to_float(centre);
  camera.eye = to_float(centre + distance * axes.back);
  return camera;
}

}  // namespace bodyopt
