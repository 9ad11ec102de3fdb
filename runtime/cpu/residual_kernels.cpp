#include "runtime/cpu/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/cpu/residual_kernels.cpp"
#include "hwy/foreach_target.h"
// Below it: what is compiled again for each set of instructions.
#include "runtime/cpu/lanes.h"

HWY_BEFORE_NAMESPACE();
namespace bodyopt::cpu::HWY_NAMESPACE {

// exp(-x) for x >= 0, within 2 ulp; 0 from kLargest on, before it is subnormal. With -x = n ln 2 + r, |r| <= ln 2 / 2,
// it is 2^n exp(r). The series of exp(r) leaves 5e-9 of it.
HWY_INLINE Lanes exp_of_negative(Lanes x) {
  constexpr float kLargest = 87.0f;
  const Lanes y = -min(x, kLargest);
  const auto n = hn::Round((y * 1.44269504f).values);
  // ln 2 in two parts, of which the first times n is exact.
  const Lanes r = (y - Lanes(n) * 0.693359375f) - Lanes(n) * -2.12194440e-4f;
  Lanes sum = 1.0f / 5040.0f;
  for (const float factorial : {720.0f, 120.0f, 24.0f, 6.0f, 2.0f, 1.0f, 1.0f}) sum = sum * r + 1.0f / factorial;
  const hn::RebindToSigned<LaneTag> whole;
  const auto exponent = hn::Add(hn::ConvertTo(whole, n), hn::Set(whole, 127));
  const Lanes power = lanes_from_bits(hn::BitCast(LaneWordTag(), hn::ShiftLeft<23>(exponent)));
  return select(x < kLargest, sum * power, 0.0f);
}

// The kernels of a region; coordinates, kernels: of the frame.
void kernel_lanes(const ResidualTable& residual, const Region& region, const float* coordinates, float* kernels) {
  const float* coordinate = coordinates + region.coordinate_begin;
  const std::uint32_t* first_row = residual.centres.data() + region.centre_values;
  for (std::uint32_t m = 0; m < region.centre_count; m += kLaneCount) {
    const LaneRows rows(m, region.centre_count, (region.coordinate_count + 1) / 2);
    Lanes distance2 = 0.0f;
    for (std::uint32_t k = 0; k < region.coordinate_count; k += 2) {
      const LaneWords words = rows.words(first_row + k / 2);
      const Lanes first = coordinate[k] - lanes_from_low_halves(words);
      distance2 += first * first;
      if (k + 1 == region.coordinate_count) break;
      const Lanes second = coordinate[k + 1] - lanes_from_high_halves(words);
      distance2 += second * second;
    }
    store_some_lanes(exp_of_negative(distance2 * region.inverse_width2), region.centre_count - m,
                     kernels + region.centre_begin + m);
  }
}

}  // namespace bodyopt::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace bodyopt::cpu {

HWY_EXPORT(kernel_lanes);

void region_kernels(const ResidualTable& residual, std::size_t region, const float* coordinates, float* kernels) {
  HWY_DYNAMIC_DISPATCH(kernel_lanes)(residual, residual.regions[region], coordinates, kernels);
}

void residual_kernels(const ResidualTable& residual, std::span<const float> coordinates, std::uint32_t frame_count,
                      std::span<float> kernels) {
  for (std::size_t f = 0; f < frame_count; ++f) {
    for (std::size_t r = 0; r < residual.regions.size(); ++r) {
      region_kernels(residual, r, coordinates.data() + f * residual.coordinate_count(),
                     kernels.data() + f * residual.centre_count());
    }
  }
}

}  // namespace bodyopt::cpu
#endif
