#include "runtime/cpu/ddm.h"
#include "runtime/cpu/kernels.h"

namespace bodyopt::cpu {

void strain_skin(const DdmTable& ddm, const StrainTable& strain, std::uint32_t joint_count,
                 std::span<const float> skinning, std::span<float> positions) {
  const std::size_t count = strain.vertices.size();
  const std::size_t frames = count == 0 ? 0 : positions.size() / (3 * count);
  const float no_delta[3] = {0, 0, 0};
  for (std::size_t f = 0; f < frames; ++f) {
    for (std::size_t k = 0; k < count; ++k) {
      float x[3];
      ddm_position(ddm, strain.vertices[k], skinning.data() + f * 12 * joint_count, no_delta, x);
      for (int i = 0; i < 3; ++i) positions[3 * (f * count + k) + static_cast<std::size_t>(i)] = x[i];
    }
  }
}

}  // namespace bodyopt::cpu
