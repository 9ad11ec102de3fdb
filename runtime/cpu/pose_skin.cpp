#include "runtime/cpu/ddm.h"
#include "runtime/cpu/kernels.h"

namespace bodyopt::cpu {

void pose_skin(const DdmTable& ddm, std::uint32_t joint_count, std::span<const float> skinning,
               std::span<const float> origins, std::span<const float> displacements, std::span<float> positions) {
  const std::size_t frames = origins.size() / 4;
  const std::size_t vertices = frames == 0 ? 0 : positions.size() / (3 * frames);
  for (std::size_t f = 0; f < frames; ++f) {
    for (std::size_t v = 0; v < vertices; ++v) {
      const std::size_t at = 3 * (f * vertices + v);
      const float delta[3] = {displacements[at], displacements[at + 1], displacements[at + 2]};
      float x[3];
      ddm_position(ddm, static_cast<std::uint32_t>(v), skinning.data() + f * 12 * joint_count, delta, x);
      for (std::size_t i = 0; i < 3; ++i) positions[at + i] = x[i] + origins[4 * f + i];
    }
  }
}

}  // namespace bodyopt::cpu
