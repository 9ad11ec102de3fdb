#include "runtime/cpu/kernels.h"

namespace bodyopt::cpu {

void residual_coefficients(const ResidualTable& residual, std::span<const float> coordinates,
                           std::span<const float> kernels, std::span<const float> rest_coefficients,
                           std::span<const float> fades, std::uint32_t frame_count, std::span<float> coefficients) {
  const std::size_t count = residual.coefficient_count(), regions = residual.regions.size();
  for (std::size_t f = 0; f < frame_count; ++f) {
    for (std::size_t c = 0; c < count; ++c) {
      const std::size_t r = residual.coefficient_region[c];
      const Region& region = residual.regions[r];
      const float* coordinate = coordinates.data() + f * residual.coordinate_count() + region.coordinate_begin;
      const float* phi = kernels.data() + f * residual.centre_count() + region.centre_begin;
      const float* row = residual.weights.data() + region.weight_values +
                         (c - region.coefficient_begin) * (1 + region.coordinate_count + region.centre_count);
      float sum = row[0];
      for (std::uint32_t k = 0; k < region.coordinate_count; ++k) sum += row[1 + k] * coordinate[k];
      for (std::uint32_t m = 0; m < region.centre_count; ++m) sum += row[1 + region.coordinate_count + m] * phi[m];
      coefficients[f * count + c] = fades[f * regions + r] * (sum - rest_coefficients[c]);
    }
  }
}

}  // namespace bodyopt::cpu
