#include <algorithm>

#include "runtime/cpu/kernels.h"
#include "runtime/cpu/vertex_frames.h"

namespace bodyopt::cpu {
namespace {

// R d + t.
void place_vertex(const DdmVertex& vertex, const float* frame, float* position) {
  const float *r = frame, *t = frame + 9;
  for (int i = 0; i < 3; ++i) {
    position[i] = t[i] + (r[3 * i] * vertex.offset_x + r[3 * i + 1] * vertex.offset_y + r[3 * i + 2] * vertex.offset_z);
  }
}

}  // namespace

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
        place_vertex(ddm.vertices[vertices[k]], frames + 12 * k, &positions[3 * (f * count + begin + k)]);
      }
    }
  }
}

}  // namespace bodyopt::cpu
