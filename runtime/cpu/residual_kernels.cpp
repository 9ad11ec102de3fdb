#include <cmath>

#include "runtime/core/half.h"
#include "runtime/cpu/kernels.h"

namespace bodyopt::cpu {

void residual_kernels(const ResidualTable& residual, std::span<const float> coordinates, std::uint32_t frame_count,
                      std::span<float> kernels) {
  const std::size_t coordinate_count = residual.coordinate_count(), centres = residual.centre_count();
  for (std::size_t f = 0; f < frame_count; ++f) {
    for (std::size_t m = 0; m < centres; ++m) {
      const Region& region = residual.regions[residual.centre_region[m]];
      const float* coordinate = coordinates.data() + f * coordinate_count + region.coordinate_begin;
      const std::size_t row_words = (region.coordinate_count + 1) / 2;
      const std::uint32_t* centre =
          residual.centres.data() + region.centre_values + (m - region.centre_begin) * row_words;
      float distance2 = 0;
      for (std::uint32_t k = 0; k < region.coordinate_count; ++k) {
        const float difference = coordinate[k] - half_low(centre[k / 2] >> 16 * (k % 2));
        distance2 += difference * difference;
      }
      kernels[f * centres + m] = std::exp(-(distance2 * region.inverse_width2));
    }
  }
}

}  // namespace bodyopt::cpu
