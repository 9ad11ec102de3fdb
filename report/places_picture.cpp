#include "report/places_picture.h"

#include <algorithm>

#include "geometry/vertex_normals.h"

namespace bodyopt {

std::vector<std::array<float, 3>> sides_of(const Positions& vertices, const Triangles& triangles,
                                           std::span<const VertexList> places) {
  constexpr std::array<std::array<float, 3>, 6> kSides = {
      {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}}};
  constexpr double kFacing = 0.5;  // cosine
  const Positions normals = vertex_normals(vertices, triangles).rowwise().normalized();
  std::array<bool, kSides.size()> is_seen = {true};
  for (const VertexList& place : places) {
    std::array<int, kSides.size()> facing{};
    for (const std::uint32_t v : place) {
      for (std::size_t s = 0; s < kSides.size(); ++s) {
        const Eigen::RowVector3d side(kSides[s][0], kSides[s][1], kSides[s][2]);
        if (normals.row(v).dot(side) > kFacing) ++facing[s];
      }
    }
    is_seen[static_cast<std::size_t>(std::max_element(facing.begin(), facing.end()) - facing.begin())] = true;
  }
  std::vector<std::array<float, 3>> sides;
  for (std::size_t s = 0; s < kSides.size(); ++s) {
    if (is_seen[s]) sides.push_back(kSides[s]);
  }
  return sides;
}

RegionPicture places_picture(Renderer& renderer, const Positions& vertices, const Triangles& triangles,
                             std::span<const VertexList> places, std::uint32_t panel_width,
                             std::uint32_t panel_height) {
  const auto count = static_cast<std::size_t>(vertices.rows());
  std::vector<bool> is_taken(count, false);
  std::vector<VertexList> own;
  for (const VertexList& place : places) {
    own.emplace_back();
    for (const std::uint32_t v : place) {
      if (!is_taken[v]) own.back().push_back(v);
      is_taken[v] = true;
    }
  }
  const std::vector<double> whole(count, 1.0);
  std::vector<DrawnRegion> drawn;
  for (const VertexList& vertices_of : own) drawn.push_back({vertices_of, std::span(whole).first(vertices_of.size())});
  const std::vector<float> skin(vertices.data(), vertices.data() + vertices.size());
  const std::span<const std::uint32_t> corners(triangles.data(), static_cast<std::size_t>(triangles.size()));
  return region_picture(renderer, skin, corners, drawn, region_colours(drawn, count), panel_width, panel_height,
                        sides_of(vertices, triangles, places));
}

}  // namespace bodyopt
