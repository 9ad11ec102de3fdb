#include "proxy_viewer/scene/skin_normal.h"

#include "runtime/basis/output_order.h"
#include "runtime/cpu/kernels.h"

namespace bodyopt {

Vec3 normal_at(const MeshTable& mesh, std::span<const float> output, std::uint32_t vertex) {
  const std::vector<float> vertices = vertices_of(mesh, output);
  std::vector<float> normals(vertices.size());
  cpu::output_normals(mesh, vertices, normals);
  const float* const at = normals.data() + std::size_t{3} * mesh.output_vertex[vertex];
  return {at[0], at[1], at[2]};
}

}  // namespace bodyopt
