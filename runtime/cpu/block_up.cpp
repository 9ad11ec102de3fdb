#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/parallel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/cpu/block_up.cpp"
#include "hwy/foreach_target.h"
// Below it: what is compiled again for each set of instructions.
#include "runtime/cpu/lane_panel.h"

HWY_BEFORE_NAMESPACE();
namespace bodyopt::cpu::HWY_NAMESPACE {

void up_panels(const BlockInverse& inverse, const InverseLevel& level, std::span<const InversePanel> panels,
               const float* gathered, std::uint32_t right_side_count, float* results) {
  for (const InversePanel& panel : panels) {
    for (std::uint32_t r = 0; r < right_side_count; ++r) {
      const float* from = gathered + std::size_t{r} * inverse.slot_count();
      float* to = results + std::size_t{r} * inverse.slot_count();
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

}  // namespace bodyopt::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace bodyopt::cpu {

HWY_EXPORT(up_panels);

void block_up(const BlockInverse& inverse, const InverseLevel& level, std::span<const float> gathered,
              std::uint32_t right_side_count, std::span<float> results, Executor& threads) {
  const auto panels = std::span(inverse.up).subspan(level.up_begin, level.up_end - level.up_begin);
  const std::size_t grain = grain_of(panels.size(), work_of(panels) * right_side_count);
  parallel_parts(threads, panels.size(), grain, [&](std::size_t begin, std::size_t end) {
    HWY_DYNAMIC_DISPATCH(up_panels)
    (inverse, level, panels.subspan(begin, end - begin), gathered.data(), right_side_count, results.data());
  });
}

}  // namespace bodyopt::cpu
#endif
