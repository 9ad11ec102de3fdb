#include <cmath>

#include "runtime/cpu/kernels.h"

namespace bodyopt::cpu {

void output_normals(const MeshTable& mesh, std::span<const float> positions, std::span<float> normals) {
  const std::size_t vertices = mesh.vertex_count();
  const std::size_t frames = vertices == 0 ? 0 : positions.size() / (3 * vertices);
  for (std::size_t f = 0; f < frames; ++f) {
    const float* x = positions.data() + 3 * f * vertices;
    for (std::size_t v = 0; v < vertices; ++v) {
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
      float* normal = normals.data() + 3 * (f * vertices + v);
      normal[0] = nx * scale;
      normal[1] = ny * scale;
      normal[2] = nz * scale;
    }
  }
}

}  // namespace bodyopt::cpu
