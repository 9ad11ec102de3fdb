#include "runtime/cpu/kernels.h"
#include "runtime/host/skin_tables.h"
#include "shaders/include/tangent.h"

namespace bodyopt::cpu {
namespace {

void tangent_of(const TangentTables& tables, const TangentVertex& vertex, std::span<const float> positions,
                std::span<const float> normals, float (&tangent)[3]) {
  const float* const a = &positions[3 * std::size_t{vertex.vertex}];
  const float* const n = &normals[3 * std::size_t{vertex.vertex}];
  const float normal[3] = {n[0], n[1], n[2]};
  float sum[4] = {};
  for (std::uint32_t k = vertex.corner_begin; k < vertex.corner_end; ++k) {
    const TangentCorner& corner = tables.corners[k];
    const float* const b = &positions[3 * std::size_t{corner.b}];
    const float* const c = &positions[3 * std::size_t{corner.c}];
    const float to_b[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, to_c[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    add_corner(corner, normal, to_b, to_c, sum);
  }
  vertex_tangent(sum, tangent);
}

}  // namespace

void output_tangents(const TangentTables& tables, std::span<const float> positions, std::span<const float> normals,
                     std::size_t first_output, std::span<float> tangents) {
  for (std::size_t at = 0; at < tangents.size(); at += 4) {
    const TangentVertex& vertex = tables.vertices[first_output + at / 4];
    float tangent[3];
    tangent_of(tables, vertex, positions, normals, tangent);
    for (std::size_t i = 0; i < 3; ++i) tangents[at + i] = tangent[i];
    tangents[at + 3] = vertex.sign;
  }
}

}  // namespace bodyopt::cpu
