#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/parallel.h"
#include "runtime/cpu/right_side.h"

namespace bodyopt::cpu {

void block_gather(const BlockInverse& inverse, const InverseLevel& level, std::span<const float> right_sides,
                  std::uint32_t right_side_count, std::uint32_t interleave, std::span<const float> results,
                  std::span<float> gathered) {
  for (std::uint32_t r = 0; r < right_side_count; ++r) {
    const RightSide at(r, interleave, inverse.unknown_count);
    const float* handed = results.data() + std::size_t{r} * inverse.slot_count();
    float* to = gathered.data() + std::size_t{r} * inverse.slot_count();
#pragma omp parallel for schedule(static) if (8 * std::size_t{level.end_slot - level.first_slot} > kParallelWork)
    for (std::uint32_t slot = level.first_slot; slot < level.end_slot; ++slot) {
      float sum = 0;
      for (std::uint32_t k = 0; k < 2; ++k) {
        const std::uint32_t child = inverse.child_slots[2 * std::size_t{slot} + k];
        if (child != kNoSlot) sum += handed[child];
      }
      to[slot] = slot < level.own_end ? right_sides[at(inverse.slot_unknown[slot])] - sum : sum;
    }
  }
}

}  // namespace bodyopt::cpu
