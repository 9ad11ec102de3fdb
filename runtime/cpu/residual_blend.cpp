#include <algorithm>

#include "runtime/core/half.h"
#include "runtime/cpu/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/cpu/residual_blend.cpp"
#include "hwy/foreach_target.h"
// Below it: what is compiled again for each set of instructions.
#include "runtime/cpu/lanes.h"

HWY_BEFORE_NAMESPACE();
namespace bodyopt::cpu::HWY_NAMESPACE {

// A signed byte of each lane.
HWY_INLINE Lanes lanes_from_bytes(const std::int8_t* bytes) {
  const hn::Rebind<std::int8_t, LaneTag> narrow;
  const hn::RebindToSigned<LaneTag> wide;
  return Lanes(hn::ConvertTo(LaneTag(), hn::PromoteTo(wide, hn::LoadU(narrow, bytes))));
}

// The displacements of a block, 3 x kBlockSize. coefficients: of the frame.
void blend_block(const ResidualTable& residual, std::uint32_t block, const float* coefficients, float weight,
                 float* displacements) {
  for (std::uint32_t lane = 0; lane < kBlockSize; lane += kLaneCount) {
    Lanes sums[3] = {0.0f, 0.0f, 0.0f};
    for (std::uint32_t e = residual.blend_begin[block]; e < residual.blend_begin[block + 1]; ++e) {
      const BlendEntry& entry = residual.blend[e];
      const auto* bytes = reinterpret_cast<const std::int8_t*>(entry.numbers) + lane;
      const Lanes amount =
          coefficients[entry.scale_coefficient >> 16] * (half_low(entry.scale_coefficient) * kBlendFraction);
      for (std::uint32_t i = 0; i < 3; ++i) sums[i] += amount * lanes_from_bytes(bytes + i * kBlockSize);
    }
    for (Lanes& sum : sums) sum = weight * sum;
    store_points(sums, displacements + 3 * lane);
  }
}

// Blocks from `block` on, as many as displacements hold; the last may not be full.
void blend_lanes(const ResidualTable& residual, const float* coefficients, float weight, std::uint32_t block,
                 std::span<float> displacements) {
  constexpr std::size_t kNumbers = 3 * kBlockSize;
  std::size_t at = 0;
  for (; at + kNumbers <= displacements.size(); at += kNumbers) {
    blend_block(residual, block++, coefficients, weight, &displacements[at]);
  }
  if (at == displacements.size()) return;
  float last[kNumbers];
  blend_block(residual, block, coefficients, weight, last);
  std::copy_n(last, displacements.size() - at, &displacements[at]);
}

}  // namespace bodyopt::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace bodyopt::cpu {

HWY_EXPORT(blend_lanes);

void blend_blocks(const ResidualTable& residual, const float* coefficients, float weight, std::uint32_t first_block,
                  std::span<float> displacements) {
  HWY_DYNAMIC_DISPATCH(blend_lanes)(residual, coefficients, weight, first_block, displacements);
}

void residual_blend(const ResidualTable& residual, std::span<const float> coefficients, std::uint32_t frame_count,
                    float weight, std::span<float> displacements) {
  const std::size_t count = residual.coefficient_count();
  const std::size_t numbers = frame_count == 0 ? 0 : displacements.size() / frame_count;
  for (std::size_t f = 0; f < frame_count; ++f) {
    blend_blocks(residual, coefficients.data() + f * count, weight, 0, displacements.subspan(f * numbers, numbers));
  }
}

}  // namespace bodyopt::cpu
#endif
