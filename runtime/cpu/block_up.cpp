#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/panel_product.h"
#include "runtime/cpu/parallel.h"

namespace bodyopt::cpu {

void block_up(const BlockInverse& inverse, const InverseLevel& level, std::span<const float> gathered,
              std::uint32_t right_side_count, std::span<float> results) {
#pragma omp parallel for schedule(static) if (work_of(inverse.up, level.up_begin, level.up_end) * right_side_count > \
                                              kParallelWork)
  for (std::uint32_t p = level.up_begin; p < level.up_end; ++p) {
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
}

}  // namespace bodyopt::cpu
