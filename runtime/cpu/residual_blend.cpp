#include "runtime/cpu/half.h"
#include "runtime/cpu/kernels.h"

namespace bodyopt::cpu {

void residual_blend(const ResidualTable& residual, std::span<const float> coefficients, std::uint32_t frame_count,
                    std::span<float> displacements) {
  const std::size_t vertices = residual.blend_begin.size() - 1, count = residual.coefficient_count();
  for (std::size_t f = 0; f < frame_count; ++f) {
    const float* c = coefficients.data() + f * count;
    for (std::size_t v = 0; v < vertices; ++v) {
      float x = 0, y = 0, z = 0;
      for (std::uint32_t e = residual.blend_begin[v]; e < residual.blend_begin[v + 1]; ++e) {
        const BlendEntry& entry = residual.blend[e];
        const float weight = c[entry.z_coefficient >> 16];
        x += weight * half_low(entry.xy);
        y += weight * half_high(entry.xy);
        z += weight * half_low(entry.z_coefficient);
      }
      float* displacement = displacements.data() + 3 * (f * vertices + v);
      displacement[0] = x;
      displacement[1] = y;
      displacement[2] = z;
    }
  }
}

}  // namespace bodyopt::cpu
