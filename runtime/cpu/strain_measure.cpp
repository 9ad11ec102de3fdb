#include <cmath>

#include "runtime/cpu/kernels.h"

namespace bodyopt::cpu {

void strain_measure(const StrainTable& strain, std::span<const float> positions, std::span<float> strains) {
  const std::size_t count = strain.vertices.size(), fibres = strain.fibre_count();
  const std::size_t frames = fibres == 0 ? 0 : strains.size() / fibres;
  for (std::size_t f = 0; f < frames; ++f) {
    const float* x = positions.data() + f * 3 * count;
    for (std::size_t k = 0; k < fibres; ++k) {
      float length = 0;
      float last[3] = {};
      for (std::uint32_t p = strain.fibre_begin[k]; p < strain.fibre_begin[k + 1]; ++p) {
        const FibrePoint& point = strain.points[p];
        float here[3];
        for (std::uint32_t i = 0; i < 3; ++i) {
          here[i] = point.wa * x[3 * point.a + i] + point.wb * x[3 * point.b + i] + point.wc * x[3 * point.c + i];
        }
        if (p > strain.fibre_begin[k]) {
          const float dx = here[0] - last[0], dy = here[1] - last[1], dz = here[2] - last[2];
          length += std::sqrt(dx * dx + dy * dy + dz * dz);
        }
        for (int i = 0; i < 3; ++i) last[i] = here[i];
      }
      strains[f * fibres + k] = (length - strain.rest_length[k]) / strain.rest_length[k];
    }
  }
}

}  // namespace bodyopt::cpu
