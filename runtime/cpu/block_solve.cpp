#include "runtime/basis/dynamics.h"
#include "runtime/cpu/dynamics_kernels.h"

namespace bodyopt::cpu {

void block_solve(const BlockInverse& inverse, std::span<const float> right_sides, std::uint32_t right_side_count,
                 std::uint32_t interleave, std::vector<float>& scratch, std::span<float> solutions, Executor& threads) {
  const std::size_t slots = std::size_t{right_side_count} * inverse.slot_count();
  scratch.resize(2 * slots);
  const std::span<float> gathered(scratch.data(), slots), results(scratch.data() + slots, slots);
  for (const InverseLevel& level : inverse.levels) {
    block_gather(inverse, level, right_sides, right_side_count, interleave, results, gathered, threads);
    block_up(inverse, level, gathered, right_side_count, results, threads);
  }
  for (auto level = inverse.levels.rbegin(); level != inverse.levels.rend(); ++level) {
    block_down(inverse, *level, results, right_side_count, interleave, solutions, threads);
  }
}

}  // namespace bodyopt::cpu
