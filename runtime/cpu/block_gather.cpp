#include "runtime/basis/dynamics.h"
#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/parallel.h"

namespace bodyopt::cpu {

void block_gather(const BlockInverse& inverse, const InverseLevel& level, std::span<const float> right_sides,
                  std::uint32_t right_side_count, std::uint32_t interleave, std::span<const float> results,
                  std::span<float> gathered, Executor& threads) {
  for (std::uint32_t r = 0; r < right_side_count; ++r) {
    const RightSide at(r, interleave, inverse.unknown_count);
    const float* handed = results.data() + std::size_t{r} * inverse.slot_count();
    float* to = gathered.data() + std::size_t{r} * inverse.slot_count();
    parallel_parts(threads, level.end_slot - level.first_slot, grain_of(8), [&](std::size_t begin, std::size_t end) {
      for (std::size_t slot = level.first_slot + begin; slot < level.first_slot + end; ++slot) {
        float sum = 0;
        for (std::uint32_t k = 0; k < 2; ++k) {
          const std::uint32_t child = inverse.child_slots[2 * slot + k];
          if (child != kNoSlot) sum += handed[child];
        }
        to[slot] = slot < level.own_end ? right_sides[at(inverse.slot_unknown[slot])] - sum : sum;
      }
    });
  }
}

}  // namespace bodyopt::cpu
