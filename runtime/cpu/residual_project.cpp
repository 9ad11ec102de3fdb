#include "runtime/core/half.h"
#include "runtime/cpu/kernels.h"

namespace bodyopt::cpu {

void residual_project(const ResidualTable& residual, std::span<const float> features, std::uint32_t frame_count,
                      std::span<float> coordinates) {
  const std::size_t count = residual.feature_count(), coordinate_count = residual.coordinate_count();
  for (std::size_t f = 0; f < frame_count; ++f) {
    const float* feature = features.data() + f * count;
    for (std::size_t c = 0; c < coordinate_count; ++c) {
      const Region& region = residual.regions[residual.coordinate_region[c]];
      const std::uint32_t* index = residual.region_features.data() + region.feature_begin;
      const std::size_t row_words = (region.feature_count + 1) / 2;
      const std::uint32_t* row =
          residual.projections.data() + region.projection_values + (c - region.coordinate_begin) * row_words;
      float sum = 0;
      for (std::uint32_t k = 0; k < region.feature_count; ++k) {
        sum += half_low(row[k / 2] >> 16 * (k % 2)) * feature[index[k]];
      }
      coordinates[f * coordinate_count + c] = sum;
    }
  }
}

}  // namespace bodyopt::cpu
