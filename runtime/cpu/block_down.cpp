#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/parallel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/cpu/block_down.cpp"
#include "hwy/foreach_target.h"
// Below it: what is compiled again for each set of instructions.
#include "runtime/cpu/lane_panel.h"

HWY_BEFORE_NAMESPACE();
namespace bodyopt::cpu::HWY_NAMESPACE {

void down_strips(const BlockInverse& inverse, std::span<const InverseStrip> strips, std::span<const float> results,
                 std::uint32_t right_side_count, std::uint32_t interleave, std::span<float> solutions) {
  thread_local std::vector<float> inputs;  // of the strip's boundary slots; kept, as they are wanted every frame
  for (const InverseStrip& strip : strips) {
    const std::uint32_t* unknown = inverse.slot_unknown.data() + strip.first_input;
    inputs.assign((strip.input_count + kBlockSize - 1) / kBlockSize * kBlockSize, 0.0f);
    for (std::uint32_t r = 0; r < right_side_count; ++r) {
      const RightSide at(r, interleave, inverse.unknown_count);
      for (std::uint32_t k = 0; k < strip.input_count; ++k) inputs[k] = solutions[at(unknown[k])];
      float sums[kBlockSize];
      strip_product(strip, inverse.values.data(), inputs.data(), sums);
      const float* from = results.data() + std::size_t{r} * inverse.slot_count();
      for (std::uint32_t row = 0; row < strip.row_count; ++row) {
        const std::uint32_t slot = strip.first_slot + row;
        solutions[at(inverse.slot_unknown[slot])] = from[slot] - sums[row];
      }
    }
  }
}

}  // namespace bodyopt::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace bodyopt::cpu {

HWY_EXPORT(down_strips);

void block_down(const BlockInverse& inverse, const InverseLevel& level, std::span<const float> results,
                std::uint32_t right_side_count, std::uint32_t interleave, std::span<float> solutions,
                Executor& threads) {
  const auto strips = std::span(inverse.down).subspan(level.down_begin, level.down_end - level.down_begin);
  const std::size_t grain = grain_of(strips.size(), work_of(strips) * right_side_count);
  parallel_parts(threads, strips.size(), grain, [&](std::size_t begin, std::size_t end) {
    HWY_DYNAMIC_DISPATCH(down_strips)
    (inverse, strips.subspan(begin, end - begin), results, right_side_count, interleave, solutions);
  });
}

}  // namespace bodyopt::cpu
#endif
