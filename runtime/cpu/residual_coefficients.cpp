#include "runtime/cpu/kernels.h"

namespace bodyopt::cpu {

void residual_coefficients(const ResidualTable& residual, std::span<const float> features,
                           std::span<const float> kernels, std::span<const float> rest_coefficients,
                           std::uint32_t frame_count, std::span<float> coefficients) {
  const std::size_t count = residual.coefficient_count();
  for (std::size_t f = 0; f < frame_count; ++f) {
    const float* feature = features.data() + f * residual.feature_count();
    for (std::size_t c = 0; c < count; ++c) {
      const Region& region = residual.regions[residual.coefficient_region[c]];
      const std::uint32_t* index = residual.region_features.data() + region.feature_begin;
      const float* phi = kernels.data() + f * residual.centre_count() + region.centre_begin;
      const float* row = residual.weights.data() + region.weight_values +
                         (c - region.coefficient_begin) * (1 + region.feature_count + region.centre_count);
      float sum = row[0];
      for (std::uint32_t k = 0; k < region.feature_count; ++k) sum += row[1 + k] * feature[index[k]];
      for (std::uint32_t m = 0; m < region.centre_count; ++m) sum += row[1 + region.feature_count + m] * phi[m];
      coefficients[f * count + c] = sum - rest_coefficients[c];
    }
  }
}

}  // namespace bodyopt::cpu
