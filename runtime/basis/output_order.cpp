#include "runtime/basis/output_order.h"

#include <algorithm>

namespace bodyopt {

std::vector<float> vertices_of(const MeshTable& mesh, std::span<const float> output, std::vector<float> vertices) {
  vertices.assign(mesh.rest.size(), 0.0f);
  for (std::size_t o = 0; o < mesh.output_vertex.size(); ++o) {
    std::copy_n(output.begin() + static_cast<std::ptrdiff_t>(3 * o), 3,
                vertices.begin() + std::ptrdiff_t{3} * mesh.output_vertex[o]);
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

}  // namespace bodyopt
