#include "report/section.h"

#include <algorithm>

namespace bodyopt {
namespace {

struct Corner {
  Vec3 position, normal;
  double height;  // above the plane
};

double height_above(const CutPlane& plane, const Vec3& point) { return dot(plane.normal, point - plane.point); }

Corner between(const Corner& a, const Corner& b) {
  const double t = a.height / (a.height - b.height);
  return {a.position + t * (b.position - a.position), a.normal + t * (b.normal - a.normal), 0};
}

// A convex polygon as a fan.
void add_polygon(std::span<const Corner> corners, const std::array<float, 3>& colour, Soup& soup) {
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
    for (const Corner& corner : {corners[0], corners[k], corners[k + 1]}) {
      soup.triangles.push_back(static_cast<std::uint32_t>(soup.positions.size() / 3));
      const double length_of_normal = std::max(length(corner.normal), 1e-12);
      for (std::size_t i = 0; i < 3; ++i) {
        soup.positions.push_back(static_cast<float>(corner.position[i]));
        soup.normals.push_back(static_cast<float>(corner.normal[i] / length_of_normal));
        soup.colours.push_back(colour[i]);
      }
    }
  }
}

}  // namespace

Soup cut_surface(std::span<const float> positions, std::span<const float> normals,
                 std::span<const std::uint32_t> triangles, const std::array<float, 3>& colour, const CutPlane& plane) {
  Soup soup;
  for (std::size_t t = 0; t < triangles.size(); t += 3) {
    std::vector<Corner> kept;
    Corner corners[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t v = 3 * std::size_t{triangles[t + k]};
      corners[k].position = {positions[v], positions[v + 1], positions[v + 2]};
      corners[k].normal = {normals[v], normals[v + 1], normals[v + 2]};
      corners[k].height = height_above(plane, corners[k].position);
    }
    for (std::size_t k = 0; k < 3; ++k) {  // Sutherland and Hodgman 1974
      const Corner &a = corners[k], &b = corners[(k + 1) % 3];
      if (a.height <= 0) kept.push_back(a);
      if ((a.height < 0 && b.height > 0) || (a.height > 0 && b.height < 0)) kept.push_back(between(a, b));
    }
    add_polygon(kept, colour, soup);
  }
  return soup;
}

Soup cut_face(std::span<const double> nodes, std::span<const int> tets, std::span<const std::array<float, 3>> colours,
              const CutPlane& plane) {
  Soup soup;
  for (std::size_t t = 0; t < colours.size(); ++t) {
    std::vector<Corner> below, above;
    for (std::size_t k = 0; k < 4; ++k) {
      const double* p = nodes.data() + 3 * static_cast<std::ptrdiff_t>(tets[4 * t + k]);
      const Vec3 position{p[0], p[1], p[2]};
      const Corner corner{position, plane.normal, height_above(plane, position)};
      (corner.height <= 0 ? below : above).push_back(corner);
    }
    if (below.empty() || above.empty()) continue;
    std::vector<Corner> polygon;
    for (const Corner& a : below) {
      for (const Corner& b : above) polygon.push_back(between(a, b));
    }
    if (polygon.size() == 4) std::swap(polygon[2], polygon[3]);  // 0-0, 0-1, 1-0, 1-1: around, not across
    const Vec3 first = polygon[1].position - polygon[0].position, last = polygon.back().position - polygon[0].position;
    if (dot(cross(first, last), plane.normal) < 0) std::reverse(polygon.begin(), polygon.end());
    add_polygon(polygon, colours[t], soup);
  }
  return soup;
}

}  // namespace bodyopt
