#include "runtime/cpu/attach_kernels.h"
#include "runtime/host/attach_tables.h"

namespace bodyopt::cpu {

void output_attach(const AttachTables& tables, std::size_t first_vertex, std::span<const float> frames,
                   std::span<float> attached) {
  for (std::size_t at = 0; at < attached.size(); at += 3) {
    const AttachVertex& vertex = tables.vertices[first_vertex + at / 3];
    const float* const frame = &frames[std::size_t{kAnchorNumbers} * vertex.anchor];
    for (std::size_t i = 0; i < 3; ++i) {
      const float away = frame[3 * i] * vertex.x + frame[3 * i + 1] * vertex.y + frame[3 * i + 2] * vertex.z;
      attached[at + i] = frame[9 + i] + away;
    }
  }
}

}  // namespace bodyopt::cpu
