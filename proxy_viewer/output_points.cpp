#include "proxy_viewer/output_points.h"

#include <algorithm>

namespace bodyopt {

std::vector<float> vertices_of(const MeshTable& mesh, std::span<const float> output) {
  std::vector<float> vertices(mesh.rest.size());
  for (std::size_t o = 0; o < mesh.output_vertex.size(); ++o) {
    std::copy_n(output.begin() + static_cast<std::ptrdiff_t>(3 * o), 3,
                vertices.begin() + static_cast<std::ptrdiff_t>(3 * mesh.output_vertex[o]));
  }
  return vertices;
}

}  // namespace bodyopt
