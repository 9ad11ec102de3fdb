#include "runtime/cpu/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/cpu/residual_coefficients.cpp"
#include "hwy/foreach_target.h"
// Below it: what is compiled again for each set of instructions.
#include "runtime/cpu/lanes.h"

HWY_BEFORE_NAMESPACE();
namespace bodyopt::cpu::HWY_NAMESPACE {

// The coefficients of a region; coordinates, kernels, coefficients: of the frame.
void coefficient_lanes(const ResidualTable& residual, const Region& region, const float* coordinates,
                       const float* kernels, const float* rest_coefficients, float fade, float* coefficients) {
  const float* first_row = residual.weights.data() + region.weight_values;
  const float* coordinate = coordinates + region.coordinate_begin;
  const float* phi = kernels + region.centre_begin;
  for (std::uint32_t c = 0; c < region.coefficient_count; c += kLaneCount) {
    const LaneRows rows(c, region.coefficient_count, 1 + region.coordinate_count + region.centre_count);
    const float* column = first_row;
    Lanes sum = rows.floats(column++);
    for (std::uint32_t k = 0; k < region.coordinate_count; ++k) sum += rows.floats(column++) * coordinate[k];
    for (std::uint32_t m = 0; m < region.centre_count; ++m) sum += rows.floats(column++) * phi[m];
    const std::uint32_t first = region.coefficient_begin + c;
    const LaneRows one_by_one(c, region.coefficient_count, 1);
    const Lanes rest = one_by_one.floats(rest_coefficients + region.coefficient_begin);
    store_some_lanes(fade * (sum - rest), region.coefficient_count - c, coefficients + first);
  }
}

}  // namespace bodyopt::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace bodyopt::cpu {

HWY_EXPORT(coefficient_lanes);

void region_coefficients(const ResidualTable& residual, std::size_t region, const float* coordinates,
                         const float* kernels, std::span<const float> rest_coefficients, float fade,
                         float* coefficients) {
  HWY_DYNAMIC_DISPATCH(coefficient_lanes)
  (residual, residual.regions[region], coordinates, kernels, rest_coefficients.data(), fade, coefficients);
}

void residual_coefficients(const ResidualTable& residual, std::span<const float> coordinates,
                           std::span<const float> kernels, std::span<const float> rest_coefficients,
                           std::span<const float> fades, std::uint32_t frame_count, std::span<float> coefficients) {
  const std::size_t regions = residual.regions.size();
  for (std::size_t f = 0; f < frame_count; ++f) {
    for (std::size_t r = 0; r < regions; ++r) {
      region_coefficients(residual, r, coordinates.data() + f * residual.coordinate_count(),
                          kernels.data() + f * residual.centre_count(), rest_coefficients, fades[f * regions + r],
                          coefficients.data() + f * residual.coefficient_count());
    }
  }
}

}  // namespace bodyopt::cpu
#endif
