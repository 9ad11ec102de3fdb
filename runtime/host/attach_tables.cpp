#include "runtime/host/attach_tables.h"

#include <algorithm>
#include <array>

#include "runtime/core/transform.h"

namespace bodyopt {
namespace {

Vec3 rest_place(const MeshTable& mesh, std::uint32_t vertex) {
  const float* const x = &mesh.rest[3 * std::size_t{vertex}];
  return {static_cast<double>(x[0]), static_cast<double>(x[1]), static_cast<double>(x[2])};
}

std::array<float, 3> to_float(const Vec3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

Vec3 over_squared_length(const Vec3& v) {
  const double squared = dot(v, v);
  return squared > 0 ? (1 / squared) * v : Vec3{};
}

void add_corner(const MeshTable& mesh, std::uint32_t vertex, AttachTables& tables) {
  AttachCorner corner{};
  corner.vertex = vertex;
  corner.fan_begin = static_cast<std::uint32_t>(tables.fans.size());
  const Vec3 here = rest_place(mesh, vertex);
  Vec3 normal{};
  for (std::uint32_t k = mesh.vertex_triangle_begin[vertex]; k < mesh.vertex_triangle_begin[vertex + 1]; ++k) {
    const std::uint32_t* const of = &mesh.triangles[3 * std::size_t{mesh.vertex_triangles[k]}];
    const std::size_t own = of[0] == vertex ? 0 : of[1] == vertex ? 1 : 2;
    const std::uint32_t b = of[(own + 1) % 3], c = of[(own + 2) % 3];
    const Vec3 to_b = rest_place(mesh, b) - here, to_c = rest_place(mesh, c) - here;
    normal = normal + cross(to_b, to_c);
    const auto [bx, by, bz] = to_float(over_squared_length(to_b));
    const auto [cx, cy, cz] = to_float(over_squared_length(to_c));
    tables.fans.push_back({b, c, bx, by, bz, cx, cy, cz});
  }
  corner.fan_end = static_cast<std::uint32_t>(tables.fans.size());
  const double edges = 2.0 * (corner.fan_end - corner.fan_begin), size = length(normal);
  const std::array<float, 3> n = to_float(size > 0 ? (0.5 * edges / size) * normal : Vec3{});
  corner.normal_x = n[0];
  corner.normal_y = n[1];
  corner.normal_z = n[2];
  corner.share = static_cast<float>(1 / std::max(1.0, edges));
  tables.corners.push_back(corner);
}

void add_mesh(const AttachedMesh& mesh, const std::vector<std::uint32_t>& corners, AttachTables& tables) {
  const auto first_anchor = static_cast<std::uint32_t>(tables.anchors.size());
  const auto first_point = static_cast<std::uint32_t>(tables.points.size());
  const auto slot = [&](std::uint32_t vertex) {
    return static_cast<std::uint32_t>(std::ranges::lower_bound(corners, vertex) - corners.begin());
  };
  for (std::size_t k = 0; k < mesh.anchors.size(); ++k) {
    const AttachmentAnchor& anchor = mesh.anchors[k];
    const std::uint32_t begin = mesh.point_begin[k], end = mesh.point_begin[k + 1];
    tables.anchors.push_back({anchor.joint, first_point + begin, first_point + end, anchor.x, anchor.y, anchor.z});
    for (std::uint32_t p = begin; p < end; ++p) {
      const SurfacePoint& at = mesh.points[p];
      const float share = 1.0f / static_cast<float>(end - begin);
      tables.points.push_back({slot(at.a), slot(at.b), slot(at.c), share * at.wa, share * at.wb, share * at.wc});
    }
  }
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    const AttachmentAnchor& anchor = mesh.anchors[mesh.vertex_anchor[v]];
    const float* const x = &mesh.rest[3 * std::size_t{v}];
    tables.vertices.push_back(
        {first_anchor + mesh.vertex_anchor[v], x[0] - anchor.x, x[1] - anchor.y, x[2] - anchor.z});
  }
  tables.vertex_begin.push_back(static_cast<std::uint32_t>(tables.vertices.size()));
}

}  // namespace

AttachTables attach_tables(const MeshTable& mesh, const Attachments& attachments) {
  std::vector<std::uint32_t> corners;
  for (const AttachedMesh& attached : attachments.meshes) {
    for (const SurfacePoint& point : attached.points) corners.insert(corners.end(), {point.a, point.b, point.c});
  }
  std::ranges::sort(corners);
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  AttachTables tables;
  tables.vertex_begin = {0};
  for (const std::uint32_t vertex : corners) add_corner(mesh, vertex, tables);
  for (const AttachedMesh& attached : attachments.meshes) add_mesh(attached, corners, tables);
  return tables;
}

}  // namespace bodyopt
