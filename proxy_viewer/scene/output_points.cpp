#include "proxy_viewer/scene/output_points.h"

#include <algorithm>

#include "runtime/cpu/kernels.h"

namespace bodyopt {

std::vector<float> vertices_of(const MeshTable& mesh, std::span<const float> output) {
  std::vector<float> vertices(mesh.rest.size());
  for (std::size_t o = 0; o < mesh.output_vertex.size(); ++o) {
    std::copy_n(output.begin() + static_cast<std::ptrdiff_t>(3 * o), 3,
                vertices.begin() + static_cast<std::ptrdiff_t>(3 * mesh.output_vertex[o]));
  }
  return vertices;
}

std::vector<float> output_of(const MeshTable& mesh, std::span<const float> vertices) {
  std::vector<float> output;
  for (const std::uint32_t v : mesh.output_vertex) {
    const auto at = vertices.begin() + static_cast<std::ptrdiff_t>(std::size_t{3} * v);
    output.insert(output.end(), at, at + 3);
  }
  return output;
}

Vec3 normal_at(const MeshTable& mesh, std::span<const float> output, std::uint32_t vertex) {
  const std::vector<float> vertices = vertices_of(mesh, output);
  std::vector<float> normals(vertices.size());
  cpu::output_normals(mesh, vertices, normals);
  const float* const at = normals.data() + std::size_t{3} * mesh.output_vertex[vertex];
  return {at[0], at[1], at[2]};
}

}  // namespace bodyopt
