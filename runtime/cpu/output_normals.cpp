#include <cmath>
#include <vector>

#include "runtime/cpu/kernels.h"

namespace bodyopt::cpu {
namespace {

void area_vector(const float* x, const std::uint32_t* triangle, float* area) {
  const float *a = x + 3 * triangle[0], *b = x + 3 * triangle[1], *c = x + 3 * triangle[2];
  const float ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
  const float wx = c[0] - a[0], wy = c[1] - a[1], wz = c[2] - a[2];
  area[0] = uy * wz - uz * wy;
  area[1] = uz * wx - ux * wz;
  area[2] = ux * wy - uy * wx;
}

void normalise(const float* sum, float* normal) {
  const float length = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
  const float scale = length > 1e-20f ? 1.0f / length : 0.0f;
  for (std::size_t i = 0; i < 3; ++i) normal[i] = sum[i] * scale;
}

}  // namespace

void area_vectors(std::span<const std::uint32_t> triangles, std::span<const float> positions,
                  std::size_t first_triangle, std::span<float> areas) {
  for (std::size_t at = 0; at < areas.size(); at += kAreaNumbers) {
    area_vector(positions.data(), &triangles[3 * (first_triangle + at / kAreaNumbers)], &areas[at]);
    areas[at + 3] = 0;
  }
}

void part_normals(const MeshTable& mesh, std::span<const std::uint32_t> vertex_triangles, std::span<const float> areas,
                  std::size_t first_vertex, std::span<float> normals) {
  for (std::size_t at = 0; at < normals.size(); at += 3) {
    const std::size_t v = first_vertex + at / 3;
    float sum[kAreaNumbers] = {};
    for (std::uint32_t k = mesh.vertex_triangle_begin[v]; k < mesh.vertex_triangle_begin[v + 1]; ++k) {
      const float* area = areas.data() + kAreaNumbers * vertex_triangles[k];
      for (std::size_t i = 0; i < kAreaNumbers; ++i) sum[i] += area[i];
    }
    normalise(sum, &normals[at]);
  }
}

void vertex_normal(const MeshTable& mesh, std::span<const float> positions, std::size_t vertex, float* normal) {
  float sum[3] = {};
  for (std::uint32_t k = mesh.vertex_triangle_begin[vertex]; k < mesh.vertex_triangle_begin[vertex + 1]; ++k) {
    float area[3];
    area_vector(positions.data(), &mesh.triangles[3 * std::size_t{mesh.vertex_triangles[k]}], area);
    for (std::size_t i = 0; i < 3; ++i) sum[i] += area[i];
  }
  normalise(sum, normal);
}

void output_normals(const MeshTable& mesh, std::span<const float> positions, std::span<float> normals) {
  const std::size_t numbers = std::size_t{3} * mesh.vertex_count();
  std::vector<float> areas(kAreaNumbers * mesh.triangles.size() / 3);
  for (std::size_t at = 0; at < positions.size(); at += numbers) {
    area_vectors(mesh.triangles, positions.subspan(at, numbers), 0, areas);
    part_normals(mesh, mesh.vertex_triangles, areas, 0, normals.subspan(at, numbers));
  }
}

}  // namespace bodyopt::cpu
