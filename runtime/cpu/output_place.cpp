#include <cstring>

#include "runtime/cpu/kernels.h"

namespace bodyopt::cpu {

void output_place(const MeshTable& mesh, std::span<const float> values, std::size_t element_stride,
                  std::size_t frame_stride, std::byte* placed) {
  const std::size_t stride = 3 * std::size_t{mesh.vertex_count()};
  if (stride == 0) return;
  for (std::size_t f = 0; f < values.size() / stride; ++f) {
    const float* frame = values.data() + f * stride;
    std::byte* to = placed + f * frame_stride;
    for (const std::uint32_t v : mesh.output_vertex) {
      std::memcpy(to, frame + 3 * std::size_t{v}, 3 * sizeof(float));
      to += element_stride;
    }
  }
}

}  // namespace bodyopt::cpu
