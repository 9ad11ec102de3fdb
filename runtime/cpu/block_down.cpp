#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/panel_product.h"
#include "runtime/cpu/right_side.h"

namespace bodyopt::cpu {

void block_down(const BlockInverse& inverse, const InverseLevel& level, std::span<const float> results,
                std::uint32_t right_side_count, std::uint32_t interleave, std::span<float> solutions) {
#pragma omp parallel for schedule(static)
  for (std::uint32_t p = level.down_begin; p < level.down_end; ++p) {
    const InversePanel& panel = inverse.down[p];
    const std::uint32_t* unknown = inverse.slot_unknown.data() + panel.first_input;
    for (std::uint32_t r = 0; r < right_side_count; ++r) {
      const RightSide at(r, interleave, inverse.unknown_count);
      const float* from = results.data() + std::size_t{r} * inverse.slot_count();
      const PanelRows sums =
          panel_product(panel, inverse.values.data(), [&](std::uint32_t c) { return solutions[at(unknown[c])]; });
      for (std::uint32_t row = 0; row < panel.row_count; ++row) {
        const std::uint32_t slot = panel.first_slot + row;
        solutions[at(inverse.slot_unknown[slot])] = from[slot] - sums[row];
      }
    }
  }
}

}  // namespace bodyopt::cpu
