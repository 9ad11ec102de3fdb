#include <cmath>

#include "runtime/cpu/kernels.h"

namespace bodyopt::cpu {

void part_normals(const MeshTable& mesh, std::span<const float> positions, std::size_t first_vertex,
                  std::span<float> normals) {
  const float* x = positions.data();
  for (std::size_t at = 0; at < normals.size(); at += 3) {
    const std::size_t v = first_vertex + at / 3;
    float nx = 0, ny = 0, nz = 0;
    for (std::uint32_t k = mesh.vertex_triangle_begin[v]; k < mesh.vertex_triangle_begin[v + 1]; ++k) {
      const std::uint32_t* t = mesh.triangles.data() + 3 * mesh.vertex_triangles[k];
      const float *a = x + 3 * t[0], *b = x + 3 * t[1], *c = x + 3 * t[2];
      const float ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
      const float wx = c[0] - a[0], wy = c[1] - a[1], wz = c[2] - a[2];
      nx += uy * wz - uz * wy;
      ny += uz * wx - ux * wz;
      nz += ux * wy - uy * wx;
    }
    const float length = std::sqrt(nx * nx + ny * ny + nz * nz);
    const float scale = length > 1e-20f ? 1.0f / length : 0.0f;
    normals[at] = nx * scale;
    normals[at + 1] = ny * scale;
    normals[at + 2] = nz * scale;
  }
}

void output_normals(const MeshTable& mesh, std::span<const float> positions, std::span<float> normals) {
  const std::size_t numbers = 3 * mesh.vertex_count();
  for (std::size_t at = 0; at < positions.size(); at += numbers) {
    part_normals(mesh, positions.subspan(at, numbers), 0, normals.subspan(at, numbers));
  }
}

}  // namespace bodyopt::cpu
