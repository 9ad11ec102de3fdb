#include "runtime/host/tangent_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace bodyopt {
namespace {

struct OrientedCorner {
  TangentCorner corner;
  bool is_mirrored;
  double angle;  // at rest
};

// By vertex of the skin and texture coordinates.
using CornersByPlace = std::map<std::pair<std::uint32_t, std::array<float, 2>>, std::vector<OrientedCorner>>;

double angle_at_rest(const MeshTable& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  double to_b[3], to_c[3], across[3], dot = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    to_b[i] = double{mesh.rest[3 * std::size_t{b} + i]} - double{mesh.rest[3 * std::size_t{a} + i]};
    to_c[i] = double{mesh.rest[3 * std::size_t{c} + i]} - double{mesh.rest[3 * std::size_t{a} + i]};
    dot += to_b[i] * to_c[i];
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    across[i] = to_b[j] * to_c[k] - to_b[k] * to_c[j];
  }
  return std::atan2(std::hypot(across[0], across[1], across[2]), dot);
}

class Corners {
 public:
  Corners(const MeshTable& mesh, std::span<const float> texture) : mesh_(mesh), texture_(texture) {
    for (std::size_t t = 0; t < mesh.output_triangles.size(); t += 3) add(&mesh.output_triangles[t]);
  }

  // Of an output vertex: mirrored or not, whichever holds the larger angle.
  std::pair<bool, std::vector<TangentCorner>> of(std::uint32_t output) const {
    std::pair<bool, std::vector<TangentCorner>> found;
    const auto at = by_place_.find(place(output));
    if (at == by_place_.end()) return found;
    double plain = 0, mirrored = 0;
    for (const OrientedCorner& corner : at->second) (corner.is_mirrored ? mirrored : plain) += corner.angle;
    found.first = mirrored > plain;
    for (const OrientedCorner& corner : at->second) {
      if (corner.is_mirrored == found.first) found.second.push_back(corner.corner);
    }
    return found;
  }

  CornersByPlace::key_type place(std::uint32_t output) const {
    return {mesh_.output_vertex[output], {texture_[2 * std::size_t{output}], texture_[2 * std::size_t{output} + 1]}};
  }

 private:
  void add(const std::uint32_t* triangle) {
    const auto [u_b, v_b] = edge(triangle[0], triangle[1]);
    const auto [u_c, v_c] = edge(triangle[0], triangle[2]);
    const double area = u_b * v_c - u_c * v_b;
    if (area == 0 || is_collapsed(triangle)) return;
    for (std::size_t k = 0; k < 3; ++k) {
      add_corner(triangle[k], triangle[(k + 1) % 3], triangle[(k + 2) % 3], area < 0);
    }
  }

  // Two of its corners are at one place at rest: an angle there is of an edge without a direction.
  bool is_collapsed(const std::uint32_t* triangle) const {
    const auto at = [&](std::size_t k) { return &mesh_.rest[3 * std::size_t{mesh_.output_vertex[triangle[k]]}]; };
    return std::equal(at(0), at(0) + 3, at(1)) || std::equal(at(1), at(1) + 3, at(2)) ||
           std::equal(at(2), at(2) + 3, at(0));
  }

  // On the texture.
  std::array<double, 2> edge(std::uint32_t from, std::uint32_t to) const {
    const auto along = [&](std::size_t i) {
      return double{texture_[2 * std::size_t{to} + i]} - double{texture_[2 * std::size_t{from} + i]};
    };
    return {along(0), along(1)};
  }

  // The tangent of a triangle, to where the first texture coordinate grows: v_c e_b - v_b e_c over the area's sign.
  void add_corner(std::uint32_t a, std::uint32_t b, std::uint32_t c, bool is_mirrored) {
    const double v_b = edge(a, b)[1], v_c = edge(a, c)[1];
    const double scale = (is_mirrored ? -1 : 1) / std::max(std::abs(v_b), std::abs(v_c));
    const std::uint32_t at = mesh_.output_vertex[a], at_b = mesh_.output_vertex[b], at_c = mesh_.output_vertex[c];
    by_place_[place(a)].push_back({{at_b, at_c, static_cast<float>(scale * v_c), static_cast<float>(-scale * v_b)},
                                   is_mirrored,
                                   angle_at_rest(mesh_, at, at_b, at_c)});
  }

  const MeshTable& mesh_;
  const std::span<const float> texture_;
  CornersByPlace by_place_;
};

}  // namespace

TangentTables tangent_tables(const MeshTable& mesh, std::span<const float> texture) {
  TangentTables tables;
  if (texture.empty()) return tables;
  const Corners corners(mesh, texture);
  std::map<CornersByPlace::key_type, TangentVertex> known;
  for (std::uint32_t output = 0; output < mesh.output_count(); ++output) {
    auto [found, is_new] = known.try_emplace(corners.place(output));
    if (is_new) {
      const auto [is_mirrored, own] = corners.of(output);
      const auto begin = static_cast<std::uint32_t>(tables.corners.size());
      tables.corners.insert(tables.corners.end(), own.begin(), own.end());
      found->second = {mesh.output_vertex[output], begin, static_cast<std::uint32_t>(tables.corners.size()),
                       is_mirrored ? -1.0f : 1.0f};
    }
    tables.vertices.push_back(found->second);
  }
  return tables;
}

}  // namespace bodyopt
