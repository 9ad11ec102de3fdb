#include <algorithm>
#include <cmath>
#include <vector>

#include "runtime/cpu/kernels.h"

namespace bodyopt::cpu {

void area_vectors(const MeshTable& mesh, std::span<const float> positions, std::size_t first_triangle,
                  std::span<float> areas) {
  const float* x = positions.data();
  for (std::size_t at = 0; at < areas.size(); at += kAreaNumbers) {
    const std::uint32_t* t = mesh.triangles.data() + 3 * (first_triangle + at / kAreaNumbers);
    const float *a = x + 3 * t[0], *b = x + 3 * t[1], *c = x + 3 * t[2];
    const float ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
    const float wx = c[0] - a[0], wy = c[1] - a[1], wz = c[2] - a[2];
    areas[at] = uy * wz - uz * wy;
    areas[at + 1] = uz * wx - ux * wz;
    areas[at + 2] = ux * wy - uy * wx;
    areas[at + 3] = 0;
  }
}

void part_normals(const MeshTable& mesh, std::span<const float> areas, std::size_t first_vertex,
                  std::span<float> normals) {
  for (std::size_t at = 0; at < normals.size(); at += 3) {
    const std::size_t v = first_vertex + at / 3;
    float sum[kAreaNumbers] = {};
    for (std::uint32_t k = mesh.vertex_triangle_begin[v]; k < mesh.vertex_triangle_begin[v + 1]; ++k) {
      const float* area = areas.data() + kAreaNumbers * mesh.vertex_triangles[k];
      for (std::size_t i = 0; i < kAreaNumbers; ++i) sum[i] += area[i];
    }
    const float length = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    const float scale = length > 1e-20f ? 1.0f / length : 0.0f;
    for (std::size_t i = 0; i < 3; ++i) normals[at + i] = sum[i] * scale;
  }
}

void output_normals(const MeshTable& mesh, std::span<const float> positions, std::span<float> normals) {
  const std::size_t numbers = std::size_t{3} * mesh.vertex_count();
  std::vector<float> areas(kAreaNumbers * mesh.triangles.size() / 3);
  for (std::size_t at = 0; at < positions.size(); at += numbers) {
    area_vectors(mesh, positions.subspan(at, numbers), 0, areas);
    part_normals(mesh, areas, 0, normals.subspan(at, numbers));
  }
}

}  // namespace bodyopt::cpu
