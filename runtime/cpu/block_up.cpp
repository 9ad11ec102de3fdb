#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/panel_product.h"
#include "runtime/cpu/parallel.h"

namespace bodyopt::cpu {

void block_up(const BlockInverse& inverse, const InverseLevel& level, std::span<const float> gathered,
              std::uint32_t right_side_count, std::span<float> results, Executor& threads) {
  const std::size_t count = level.up_end - level.up_begin;
  const std::size_t work = work_of(inverse.up, level.up_begin, level.up_end) * right_side_count;
  parallel_for(threads, count, grain_of(count, work), [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = level.up_begin + begin; p < level.up_begin + end; ++p) {
      const InversePanel& panel = inverse.up[p];
      for (std::uint32_t r = 0; r < right_side_count; ++r) {
        const float* from = gathered.data() + std::size_t{r} * inverse.slot_count();
        float* to = results.data() + std::size_t{r} * inverse.slot_count();
        float sums[kBlockSize];
        panel_product(panel, inverse.values.data(), from + panel.first_input, sums);
        const bool is_boundary = panel.first_slot >= level.own_end;
        for (std::uint32_t row = 0; row < panel.row_count; ++row) {
          const std::uint32_t slot = panel.first_slot + row;
          to[slot] = is_boundary ? from[slot] + sums[row] : sums[row];
        }
      }
    }
  });
}

}  // namespace bodyopt::cpu
