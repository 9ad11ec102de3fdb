#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/panel_product.h"
#include "runtime/cpu/parallel.h"
#include "runtime/cpu/right_side.h"

namespace bodyopt::cpu {

void block_down(const BlockInverse& inverse, const InverseLevel& level, std::span<const float> results,
                std::uint32_t right_side_count, std::uint32_t interleave, std::span<float> solutions,
                Executor& threads) {
  const std::size_t count = level.down_end - level.down_begin;
  const std::size_t work = work_of(inverse.down, level.down_begin, level.down_end) * right_side_count;
  parallel_for(threads, count, grain_of(count, work), [&](std::size_t begin, std::size_t end) {
    std::vector<float> inputs;  // of the strip's boundary slots
    for (std::size_t p = level.down_begin + begin; p < level.down_begin + end; ++p) {
      const InverseStrip& strip = inverse.down[p];
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
  });
}

}  // namespace bodyopt::cpu
