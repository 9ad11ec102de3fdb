#include "trainer/anatomy/pixels_inside.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace bodyopt {
namespace {

// Where a row of pixels enters (1) or leaves (-1) the skin.
struct Crossing {
  double at;  // pixels from the left
  int turn;
};

// Of a triangle's corners above and below a plane: where its edges pass through, in pixels from the corner.
std::vector<Eigen::Vector2d> cut_triangle(const SectionPlane& plane, const std::array<Eigen::Vector3d, 3>& corners) {
  const Eigen::Vector3d normal = plane.right.cross(plane.down);
  std::vector<Eigen::Vector2d> ends;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d a = corners[k] - plane.corner, b = corners[(k + 1) % 3] - plane.corner;
    const double above = normal.dot(a), below = normal.dot(b);
    if ((above > 0) == (below > 0)) continue;
    const Eigen::Vector3d at = (a + above / (above - below) * (b - a)) / plane.pixel;
    ends.emplace_back(plane.right.dot(at), plane.down.dot(at));
  }
  return ends;
}

std::vector<std::vector<Crossing>> crossings_of_rows(const SectionPlane& plane, const Positions& skin,
                                                     const Triangles& triangles) {
  std::vector<std::vector<Crossing>> rows(static_cast<std::size_t>(plane.height));
  for (const auto& triangle : triangles.rowwise()) {
    std::array<Eigen::Vector3d, 3> corners;
    for (int k = 0; k < 3; ++k) corners[static_cast<std::size_t>(k)] = skin.row(triangle[k]);
    const std::vector<Eigen::Vector2d> ends = cut_triangle(plane, corners);
    if (ends.size() != 2) continue;
    const Eigen::Vector3d outward = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    const int turn = plane.right.dot(outward) < 0 ? 1 : -1;
    const auto [upper, lower] =
        std::minmax(ends[0], ends[1], [](const auto& a, const auto& b) { return a.y() < b.y(); });
    const double last = std::min(std::ceil(lower.y() - 0.5), double(plane.height));
    for (double row = std::max(0.0, std::ceil(upper.y() - 0.5)); row < last; ++row) {
      const double share = (row + 0.5 - upper.y()) / (lower.y() - upper.y());
      rows[static_cast<std::size_t>(row)].push_back({std::lerp(upper.x(), lower.x(), share), turn});
    }
  }
  for (std::vector<Crossing>& row : rows) {
    std::ranges::stable_sort(row, {}, &Crossing::at);
  }
  return rows;
}

}  // namespace

std::vector<bool> pixels_inside(const SectionPlane& plane, const Positions& skin, const Triangles& triangles) {
  std::vector<bool> inside(static_cast<std::size_t>(plane.size()));
  const std::vector<std::vector<Crossing>> rows = crossings_of_rows(plane, skin, triangles);
  for (std::size_t y = 0; y < rows.size(); ++y) {
    auto next = rows[y].begin();
    int winding = 0;
    for (int x = 0; x < plane.width; ++x) {
      for (; next != rows[y].end() && next->at < x + 0.5; ++next) winding += next->turn;
      inside[y * static_cast<std::size_t>(plane.width) + static_cast<std::size_t>(x)] = winding != 0;
    }
  }
  return inside;
}

RestPoints rest_points(const SectionPlane& plane, const Positions& skin, const Triangles& triangles) {
  const std::vector<bool> inside = pixels_inside(plane, skin, triangles);
  RestPoints points(inside.size());
  for (std::size_t pixel = 0; pixel < inside.size(); ++pixel) {
    if (inside[pixel]) points[pixel] = RestPoint{plane.middle(static_cast<int>(pixel))};
  }
  return points;
}

}  // namespace bodyopt
