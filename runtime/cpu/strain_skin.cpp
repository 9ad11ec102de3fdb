#include <algorithm>

#include "runtime/cpu/ddm_frames.h"
#include "runtime/cpu/kernels.h"

namespace bodyopt::cpu {
namespace {

// R d + t. The numbers of the frame stand `stride` apart.
void place_vertex(const DdmVertex& vertex, const float* frame, std::size_t stride, float* position) {
  const float d[3] = {vertex.offset_x, vertex.offset_y, vertex.offset_z};
  for (std::size_t i = 0; i < 3; ++i) {
    const float* row = frame + 3 * i * stride;
    position[i] = frame[(9 + i) * stride] + (row[0] * d[0] + row[stride] * d[1] + row[2 * stride] * d[2]);
  }
}

}  // namespace

void place_strain_vertices(const DdmTable& ddm, const StrainTable& strain, std::span<const float> frames,
                           std::span<float> positions) {
  for (std::size_t k = 0; k < strain.vertices.size(); ++k) {
    const std::uint32_t v = strain.vertices[k];
    place_vertex(ddm.vertices[v], &frames[v / kBlockSize * kFrameNumbers + v % kBlockSize], kBlockSize,
                 &positions[3 * k]);
  }
}

void strain_skin(const DdmTable& ddm, const StrainTable& strain, std::uint32_t joint_count,
                 std::span<const float> skinning, std::span<float> positions) {
  constexpr std::size_t kPart = 256;  // vertices whose frames are known at a time
  const std::size_t count = strain.vertices.size();
  const std::size_t frame_count = count == 0 ? 0 : positions.size() / (3 * count);
  float frames[12 * kPart];
  for (std::size_t f = 0; f < frame_count; ++f) {
    for (std::size_t begin = 0; begin < count; begin += kPart) {
      const auto vertices = std::span(strain.vertices).subspan(begin, std::min(kPart, count - begin));
      vertex_frames(ddm, vertices, skinning.data() + f * 12 * joint_count, frames);
      for (std::size_t k = 0; k < vertices.size(); ++k) {
        place_vertex(ddm.vertices[vertices[k]], frames + 12 * k, 1, &positions[3 * (f * count + begin + k)]);
      }
    }
  }
}

}  // namespace bodyopt::cpu
