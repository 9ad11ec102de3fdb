#include "report/muscle_picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "report/pictures.h"

namespace bodyopt {
namespace {

constexpr std::size_t kRings = 24, kSides = 10;
constexpr double kThinnest = 0.0015;  // metres: tendons, where the belly ends

struct Mesh {
  std::vector<float> positions, colours;
  std::vector<std::uint32_t> triangles;
};

void add_vertex(const Vec3& position, const Vec3& colour, Mesh& mesh) {
  for (std::size_t i = 0; i < 3; ++i) {
    mesh.positions.push_back(static_cast<float>(position[i]));
    mesh.colours.push_back(static_cast<float>(colour[i]));
  }
}

// Points at equal distances along a path.
std::vector<Vec3> resample(const std::vector<Vec3>& path) {
  std::vector<double> arc{0};
  for (std::size_t k = 1; k < path.size(); ++k) arc.push_back(arc.back() + length(path[k] - path[k - 1]));
  std::vector<Vec3> points;
  std::size_t k = 1;
  for (std::size_t ring = 0; ring < kRings; ++ring) {
    const double at = arc.back() * static_cast<double>(ring) / (kRings - 1);
    while (k + 1 < path.size() && arc[k] < at) ++k;
    const double t = std::clamp((at - arc[k - 1]) / std::max(arc[k] - arc[k - 1], 1e-12), 0.0, 1.0);
    points.push_back(path[k - 1] + t * (path[k] - path[k - 1]));
  }
  return points;
}

void add_tube(const MuscleTube& muscle, const Vec3& colour, Mesh& mesh) {
  const std::vector<Vec3> points = resample(muscle.path);
  const auto first = static_cast<std::uint32_t>(mesh.positions.size() / 3);
  Vec3 across = {1, 0, 0};
  for (std::size_t ring = 0; ring < kRings; ++ring) {
    Vec3 along = points[std::min(ring + 1, kRings - 1)] - points[ring == 0 ? 0 : ring - 1];
    along = (1 / std::max(length(along), 1e-12)) * along;
    across = across - dot(across, along) * along;
    if (length(across) < 0.1) across = cross(along, std::abs(along[1]) < 0.9 ? Vec3{0, 1, 0} : Vec3{0, 0, 1});
    across = (1 / length(across)) * across;
    const Vec3 other = cross(along, across);
    const double u = static_cast<double>(ring) / (kRings - 1);
    const double radius = std::max(muscle.radius * std::sqrt(std::max(std::sin(std::numbers::pi * u), 0.0)), kThinnest);
    for (std::size_t side = 0; side < kSides; ++side) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(side) / kSides;
      add_vertex(points[ring] + radius * (std::cos(angle) * across + std::sin(angle) * other), colour, mesh);
    }
  }
  for (std::uint32_t ring = 0; ring + 1 < kRings; ++ring) {
    for (std::uint32_t side = 0; side < kSides; ++side) {
      const std::uint32_t next = (side + 1) % kSides;
      const std::uint32_t a = first + ring * kSides + side, b = first + ring * kSides + next;
      for (const std::uint32_t v : {a, b, a + static_cast<std::uint32_t>(kSides), b,
                                    b + static_cast<std::uint32_t>(kSides), a + static_cast<std::uint32_t>(kSides)}) {
        mesh.triangles.push_back(v);
      }
    }
  }
}

// Reds that differ, so that neighbours can be told apart.
Vec3 muscle_colour(std::size_t index) {
  const double shade = std::fmod(0.618034 * static_cast<double>(index), 1.0);
  return {0.45 + 0.35 * shade, 0.08 + 0.22 * std::fmod(3 * shade, 1.0), 0.07 + 0.1 * shade};
}

std::vector<std::uint32_t> facing_away(std::span<const std::uint32_t> triangles, std::span<const float> normals,
                                       const std::array<float, 3>& direction) {
  std::vector<std::uint32_t> kept;
  for (std::size_t t = 0; t < triangles.size(); t += 3) {
    float towards = 0;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      for (std::size_t i = 0; i < 3; ++i) towards += normals[3 * std::size_t{triangles[t + corner]} + i] * direction[i];
    }
    if (towards < 0)
      kept.insert(kept.end(), triangles.begin() + static_cast<std::ptrdiff_t>(t),
                  triangles.begin() + static_cast<std::ptrdiff_t>(t + 3));
  }
  return kept;
}

}  // namespace

Image muscle_picture(Renderer& renderer, std::span<const float> skin, std::span<const std::uint32_t> triangles,
                     std::span<const MuscleTube> muscles, std::uint32_t panel_width, std::uint32_t panel_height) {
  Mesh tubes;
  for (std::size_t m = 0; m < muscles.size(); ++m) add_tube(muscles[m], muscle_colour(m), tubes);
  const std::vector<float> tube_normals = smooth_normals(tubes.triangles, tubes.positions);
  const std::vector<float> skin_normals = smooth_normals(triangles, skin);
  // Seen from inside, the skin is lit from inside.
  std::vector<float> inner_normals = skin_normals;
  for (float& value : inner_normals) value = -value;
  std::vector<Image> panels;
  for (const std::array<float, 3>& direction :
       {std::array{0.0f, 0.0f, 1.0f}, std::array{0.0f, 0.0f, -1.0f}, std::array{1.0f, 0.0f, 0.0f}}) {
    const std::vector<std::uint32_t> shell = facing_away(triangles, skin_normals, direction);
    const DrawMesh meshes[2] = {{skin, inner_normals, shell, {}},
                                {tubes.positions, tube_normals, tubes.triangles, tubes.colours}};
    const Camera camera =
        frame_points(skin, direction, static_cast<float>(panel_width) / static_cast<float>(panel_height));
    panels.push_back(renderer.draw(meshes, camera, panel_width, panel_height));
  }
  return side_by_side(panels);
}

}  // namespace bodyopt
