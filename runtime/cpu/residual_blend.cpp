#include <algorithm>

#include "runtime/cpu/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/cpu/residual_blend.cpp"
#include "hwy/foreach_target.h"
// Below it: what is compiled again for each set of instructions.
#include "runtime/cpu/lane_blend.h"

HWY_BEFORE_NAMESPACE();
namespace bodyopt::cpu::HWY_NAMESPACE {

// The displacements of a block, 3 x kBlockSize. coefficients: of the frame.
void blend_block(const ResidualTable& residual, std::uint32_t block, const float* coefficients, float weight,
                 float* displacements) {
  const auto entries =
      std::span(residual.blend)
          .subspan(residual.blend_begin[block], residual.blend_begin[block + 1] - residual.blend_begin[block]);
  for (std::uint32_t lane = 0; lane < kBlockSize; lane += kLaneCount) {
    Lanes sums[3];
    blend_entries(entries, lane, coefficients, sums);
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
