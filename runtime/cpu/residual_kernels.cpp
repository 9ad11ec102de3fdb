#include <cmath>

#include "runtime/cpu/half.h"
#include "runtime/cpu/kernels.h"

namespace bodyopt::cpu {

void residual_kernels(const ResidualTable& residual, std::span<const float> features, std::uint32_t frame_count,
                      std::span<float> kernels) {
  const std::size_t count = residual.feature_count(), centres = residual.centre_count();
  for (std::size_t f = 0; f < frame_count; ++f) {
    const float* feature = features.data() + f * count;
    for (std::size_t m = 0; m < centres; ++m) {
      const Region& region = residual.regions[residual.centre_region[m]];
      const std::uint32_t* index = residual.region_features.data() + region.feature_begin;
      const std::size_t row_words = (region.feature_count + 1) / 2;
      const std::uint32_t* centre =
          residual.centres.data() + region.centre_values + (m - region.centre_begin) * row_words;
      float distance2 = 0;
      for (std::uint32_t k = 0; k < region.feature_count; ++k) {
        const float difference = feature[index[k]] - half_low(centre[k / 2] >> 16 * (k % 2));
        distance2 += difference * difference;
      }
      kernels[f * centres + m] = std::exp(-(distance2 * region.inverse_width2));
    }
  }
}

}  // namespace bodyopt::cpu
