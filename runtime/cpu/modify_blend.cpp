#include <algorithm>

#include "runtime/cpu/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/cpu/modify_blend.cpp"
#include "hwy/foreach_target.h"
// Below it: what is compiled again for each set of instructions.
#include "runtime/cpu/lane_blend.h"

HWY_BEFORE_NAMESPACE();
namespace bodyopt::cpu::HWY_NAMESPACE {

// Adds to the displacements of a block, 3 x kBlockSize.
void modify_block(std::span<const BlendEntry> entries, const float* weights, float* displacements) {
  for (std::uint32_t lane = 0; lane < kBlockSize; lane += kLaneCount) {
    Lanes sums[3], values[3];
    blend_entries(entries, lane, weights, sums);
    load_points(displacements + 3 * lane, values);
    for (int i = 0; i < 3; ++i) values[i] += sums[i];
    store_points(values, displacements + 3 * lane);
  }
}

// Blocks from `block` on, as many as displacements hold; the last may not be full.
void modify_lanes(const SkinModifiers& modifiers, const float* weights, std::uint32_t block,
                  std::span<float> displacements) {
  constexpr std::size_t kNumbers = 3 * kBlockSize;
  for (std::size_t at = 0; at < displacements.size(); at += kNumbers, ++block) {
    const std::uint32_t begin = modifiers.blend_begin[block], end = modifiers.blend_begin[block + 1];
    const auto entries = std::span(modifiers.blend).subspan(begin, end - begin);
    const std::size_t count = std::min(kNumbers, displacements.size() - at);
    if (entries.empty()) continue;
    if (count == kNumbers) {
      modify_block(entries, weights, &displacements[at]);
      continue;
    }
    float last[kNumbers] = {};
    std::copy_n(&displacements[at], count, last);
    modify_block(entries, weights, last);
    std::copy_n(last, count, &displacements[at]);
  }
}

}  // namespace bodyopt::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace bodyopt::cpu {

HWY_EXPORT(modify_lanes);

void modify_blocks(const SkinModifiers& modifiers, const float* weights, std::uint32_t first_block,
                   std::span<float> displacements) {
  HWY_DYNAMIC_DISPATCH(modify_lanes)(modifiers, weights, first_block, displacements);
}

void modify_blend(const SkinModifiers& modifiers, std::span<const float> weights, std::uint32_t frame_count,
                  std::span<float> displacements) {
  const std::size_t numbers = frame_count == 0 ? 0 : displacements.size() / frame_count;
  const std::size_t count = frame_count == 0 ? 0 : weights.size() / frame_count;
  for (std::size_t f = 0; f < frame_count; ++f) {
    modify_blocks(modifiers, weights.data() + f * count, 0, displacements.subspan(f * numbers, numbers));
  }
}

}  // namespace bodyopt::cpu
#endif
