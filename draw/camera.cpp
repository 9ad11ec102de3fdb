#include "draw/camera.h"

#include <algorithm>
#include <cmath>

#include "runtime/core/error.h"

namespace bodyopt::draw {
namespace {

constexpr double kMargin = 1.08;  // of the box's extent

Vec3 normalised(const Vec3& v, const Vec3& otherwise) {
  const double size = length(v);
  return std::isfinite(size) && size > 1e-12 ? (1 / size) * v : otherwise;
}

bool all_in_range(std::span<const float> v) {
  return std::all_of(v.begin(), v.end(), [](float x) { return std::abs(x) <= kMaxCoordinate; });
}

}  // namespace

ViewAxes view_axes(const Vec3& direction) {
  ViewAxes axes;
  axes.back = normalised(direction, {0, 0, 1});
  // Near the poles right stays right.
  const Vec3 above = std::abs(axes.back[1]) > 0.999 ? Vec3{0, 0, -std::copysign(1.0, axes.back[1])} : Vec3{0, 1, 0};
  axes.right = normalised(cross(above, axes.back), {1, 0, 0});
  axes.up = cross(axes.back, axes.right);
  return axes;
}

ViewAxes view_axes(const Camera& camera) {
  ViewAxes axes = view_axes(to_double(camera.eye) - to_double(camera.target));
  axes.right = normalised(cross(to_double(camera.up), axes.back), axes.right);
  axes.up = cross(axes.back, axes.right);
  return axes;
}

std::array<std::array<float, 4>, 3> view_matrix(const Camera& camera) {
  if (!all_in_range(camera.eye) || !all_in_range(camera.target) || !(camera.vertical_angle > 0) ||
      !(camera.vertical_angle < 3.1f)) {
    throw Error(ErrorKind::usage,
                "a camera must have a finite eye and target and a vertical angle between 0 and 3.1 radians");
  }
  if (!(camera.orthographic_height >= 0 && camera.orthographic_height <= kMaxCoordinate)) {
    throw Error(ErrorKind::usage, "the height that an orthographic camera sees is ", camera.orthographic_height,
                " m, expected a finite height of 0 (perspective) or more");
  }
  const Vec3 eye = to_double(camera.eye);
  const ViewAxes axes = view_axes(camera);
  std::array<std::array<float, 4>, 3> rows;
  const Vec3* const all[3] = {&axes.right, &axes.up, &axes.back};
  for (std::size_t r = 0; r < 3; ++r) {
    const Vec3& axis = *all[r];
    const std::array<float, 3> xyz = to_float(axis);
    rows[r] = {xyz[0], xyz[1], xyz[2], static_cast<float>(-dot(axis, eye))};
  }
  return rows;
}

double distance_to_target(const Camera& camera) { return length(to_double(camera.eye) - to_double(camera.target)); }

std::array<float, 4> projection(const Camera& camera, const DepthRange& seen, double aspect) {
  const auto cut = [&](double nearest) {
    return camera.cut_away ? std::max(nearest, distance_to_target(camera)) : nearest;
  };
  if (camera.orthographic_height > 0) {
    const double margin = 0.01 * std::max(seen.farthest - seen.nearest, 0.0) + 1e-3;
    const double n = cut(seen.nearest - margin), f = std::max(seen.farthest, n) + margin;
    const double scale = 2 / static_cast<double>(camera.orthographic_height);
    return {static_cast<float>(scale / aspect), static_cast<float>(scale), static_cast<float>(1 / (n - f)),
            static_cast<float>(n / (n - f))};
  }
  const double near = cut(0.99 * seen.nearest), behind_cut = camera.cut_away ? 1.2 * near : 0;
  const double f = std::max({1.01 * seen.farthest, behind_cut, 1e-3}), n = std::clamp(near, 1e-3 * f, 0.9 * f);
  const double scale = 1 / std::tan(0.5 * static_cast<double>(camera.vertical_angle));
  return {static_cast<float>(scale / aspect), static_cast<float>(scale), static_cast<float>(f / (n - f)),
          static_cast<float>(n * f / (n - f))};
}

Camera frame_points(std::span<const float> points, const std::array<float, 3>& direction, float aspect) {
  if (points.empty() || points.size() % 3 != 0 || !all_in_range(points) || !(aspect > 0) || !std::isfinite(aspect)) {
    throw Error(ErrorKind::usage, "points to frame must be three finite numbers each, and the aspect ratio positive");
  }
  const ViewAxes axes = view_axes(to_double(direction));
  const Vec3* const all[3] = {&axes.right, &axes.up, &axes.back};
  const auto along = [&](std::size_t axis, std::size_t at) {
    return dot(*all[axis], Vec3{points[at], points[at + 1], points[at + 2]});
  };
  Vec3 centre{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double low = along(axis, 0), high = low;
    for (std::size_t at = 3; at < points.size(); at += 3) {
      low = std::min(low, along(axis, at));
      high = std::max(high, along(axis, at));
    }
    centre = centre + 0.5 * (low + high) * *all[axis];
  }
  const double tan_y = std::tan(kVerticalAngle / 2.0), tan_x = tan_y * static_cast<double>(aspect);
  // The camera sees a point, (x, y, z) from the centre in its axes, from a distance of z + |x| / tan_x or more.
  double distance = 1e-3;
  for (std::size_t at = 0; at < points.size(); at += 3) {
    const double x = std::abs(along(0, at) - dot(axes.right, centre)),
                 y = std::abs(along(1, at) - dot(axes.up, centre));
    const double z = along(2, at) - dot(axes.back, centre);
    distance = std::max(distance, z + kMargin * std::max(x / tan_x, y / tan_y));
  }
  return {to_float(centre + distance * axes.back), to_float(centre), kVerticalAngle};
}

Camera frame_box(const std::array<float, 3>& low, const std::array<float, 3>& high,
                 const std::array<float, 3>& direction, float aspect) {
  std::array<float, 24> corners;
  for (std::size_t c = 0; c < 8; ++c) {
    for (std::size_t i = 0; i < 3; ++i) corners[3 * c + i] = c >> i & 1 ? high[i] : low[i];
  }
  return frame_points(corners, direction, aspect);
}

}  // namespace bodyopt::draw
