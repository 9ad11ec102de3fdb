#include "viewport/picking.h"

#include <algorithm>
#include <cmath>
#include <ranges>

#include "draw/camera.h"
#include "runtime/basis/output_order.h"

namespace bodyopt::viewport {
namespace {

constexpr double kPickRadius = 14;  // pixels

double aspect_of(const draw::Rectangle& area) { return static_cast<double>(area.width) / std::max(1u, area.height); }

Vec3 vertex(std::span<const float> vertices, std::uint32_t index) {
  const float* at = vertices.data() + std::size_t{3} * index;
  return {at[0], at[1], at[2]};
}

// Returns the distance along the ray, and shares of b and c; none: it passes by (Möller and Trumbore 1997).
std::optional<std::array<double, 3>> hit(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, across = cross(ray.along, ac);
  const double determinant = dot(ab, across);
  if (determinant == 0) return std::nullopt;
  const Vec3 from_a = ray.from - a, other = cross(from_a, ab);
  const double u = dot(from_a, across) / determinant, v = dot(ray.along, other) / determinant;
  if (u < 0 || v < 0 || u + v > 1) return std::nullopt;
  return std::array{dot(ac, other) / determinant, u, v};
}

// Returns the ray through a pixel of the area that the camera fills.
Ray ray_in(const draw::Rectangle& area, const draw::Camera& camera, const std::array<double, 2>& pixel) {
  const auto [x, y] = pixel;
  const Vec3 eye = draw::to_double(camera.eye);
  const draw::ViewAxes axes = draw::view_axes(camera);
  const auto scale = draw::projection(camera, {0, 1}, aspect_of(area));
  const double right = (2 * (x - area.x) / std::max(1u, area.width) - 1) / static_cast<double>(scale[0]);
  const double up = (1 - 2 * (y - area.y) / std::max(1u, area.height)) / static_cast<double>(scale[1]);
  const Vec3 across = right * axes.right + up * axes.up;
  const double cut = camera.cut_away ? draw::distance_to_target(camera) : 0;
  if (camera.orthographic_height > 0) return {eye + across, -1 * axes.back, camera.cut_away ? cut : -1e30};
  return {eye, across - axes.back, cut};
}

}  // namespace

draw::Rectangle view_at(const Scene& scene, const Controls& controls, const draw::Rectangle& picture, float x) {
  const std::vector<draw::Rectangle> views = scene.view_areas(controls.settings, picture);
  return x < static_cast<float>(views.back().x) ? views.front() : views.back();
}

std::optional<std::array<double, 2>> pixel_of(const Scene& scene, const Controls& controls,
                                              const draw::Rectangle& picture, float x, const Vec3& point) {
  const draw::Rectangle area = view_at(scene, controls, picture, x);
  const draw::Camera camera = controls.camera.camera();
  const auto rows = draw::view_matrix(camera);
  const auto scale = draw::projection(camera, {0, 1}, aspect_of(area));
  double at[3];
  for (std::size_t r = 0; r < 3; ++r) {
    at[r] = static_cast<double>(rows[r][3]);
    for (std::size_t i = 0; i < 3; ++i) at[r] += static_cast<double>(rows[r][i]) * point[i];
  }
  const double w = camera.orthographic_height > 0 ? 1 : -at[2];
  if (w <= 0) return std::nullopt;
  return std::array{area.x + 0.5 * area.width * (1 + static_cast<double>(scale[0]) * at[0] / w),
                    area.y + 0.5 * area.height * (1 - static_cast<double>(scale[1]) * at[1] / w)};
}

std::string joint_at(const Scene& scene, const Controls& controls, const draw::Rectangle& picture, float x, float y) {
  const std::vector<Vec3> centres = scene.joint_centres(controls);
  double nearest = kPickRadius;
  std::string joint;
  for (std::size_t j = 0; j < centres.size(); ++j) {
    const auto pixel = pixel_of(scene, controls, picture, x, centres[j]);
    if (!pixel) continue;
    const double distance = std::hypot((*pixel)[0] - static_cast<double>(x), (*pixel)[1] - static_cast<double>(y));
    if (distance >= nearest) continue;
    nearest = distance;
    joint = scene.lead().basis().skeleton.joints[j].name;
  }
  return joint;
}

std::string joint_under_skin_at(Scene& scene, const Controls& controls, const draw::Rectangle& picture, float x,
                                float y) {
  const Ray ray = ray_through(scene, controls, picture, {x, y});
  const MeshTable& mesh = scene.lead().finest_basis().mesh;
  const std::optional<RayHit> hit = first_hit(ray, vertices_of(mesh, scene.lead_skin(controls)), mesh.triangles);
  if (!hit) return "";
  const std::vector<Vec3> centres = scene.joint_centres(controls);
  const auto nearest =
      std::ranges::min_element(centres, {}, [&](const Vec3& centre) { return length(centre - hit->at); });
  return scene.lead().basis().skeleton.joints[static_cast<std::size_t>(nearest - centres.begin())].name;
}

std::optional<PickedVertex> vertex_at(Scene& scene, const Controls& controls, const draw::Rectangle& picture, float x,
                                      float y) {
  const Ray ray = ray_through(scene, controls, picture, {x, y});
  std::optional<PickedVertex> picked;
  double nearest = 0;
  for (std::size_t c = 0; c < std::min<std::size_t>(2, scene.cast().size()); ++c) {
    const std::vector<float> skin = scene.skin_on_stage(c, controls);
    const std::optional<RayHit> hit = first_hit(ray, skin, scene.cast()[c]->finest_basis().mesh.output_triangles);
    if (!hit) continue;
    const double along = dot(hit->at - ray.from, ray.along);
    if (picked && along >= nearest) continue;
    nearest = along;
    const auto vertices = std::views::iota(0u, static_cast<std::uint32_t>(skin.size() / 3));
    picked = {c, std::ranges::min(vertices, {}, [&](std::uint32_t v) { return length(vertex(skin, v) - hit->at); })};
  }
  return picked;
}

Ray ray_through(const Scene& scene, const Controls& controls, const draw::Rectangle& picture,
                const std::array<double, 2>& pixel) {
  return ray_in(view_at(scene, controls, picture, static_cast<float>(pixel[0])), controls.camera.camera(), pixel);
}

std::optional<Vec3> moved_under_pixel(const Scene& scene, const Controls& controls, const draw::Rectangle& picture,
                                      float x, const std::array<double, 2>& pixel, const Vec3& point) {
  const draw::Camera camera = controls.camera.camera();
  const Vec3 towards = draw::to_double(camera.eye) - draw::to_double(camera.target);
  const Ray ray = ray_in(view_at(scene, controls, picture, x), camera, pixel);
  const double slope = dot(ray.along, towards);
  if (slope == 0) return std::nullopt;
  return ray.from + (dot(point - ray.from, towards) / slope) * ray.along;
}

std::optional<RayHit> first_hit(const Ray& ray, std::span<const float> vertices,
                                std::span<const std::uint32_t> triangles) {
  const auto corner = [&](std::size_t k) { return vertex(vertices, triangles[k]); };
  std::optional<std::array<double, 3>> first;
  std::size_t where = 0;
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) {
    const auto at = hit(ray, corner(t), corner(t + 1), corner(t + 2));
    if (!at || (*at)[0] <= ray.least || (first && (*at)[0] >= (*first)[0])) continue;
    first = at;
    where = t;
  }
  if (!first) return std::nullopt;
  const auto [along, b, c] = *first;
  const Vec3 across = cross(corner(where + 1) - corner(where), corner(where + 2) - corner(where));
  const double towards = dot(across, ray.along) > 0 ? -1 : 1;
  return RayHit{ray.from + along * ray.along, towards / length(across) * across, where / 3, {1 - b - c, b, c}};
}

}  // namespace bodyopt::viewport
