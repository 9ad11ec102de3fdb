#include "runtime/vulkan/backend/block_solve.h"

namespace bodyopt::vulkan {

BlockSolve::BlockSolve(const Device& device) : gather_(device), up_(device), down_(device) {}

void BlockSolve::record(Commands& commands, const Buffers& buffers, std::uint32_t right_side_count,
                        std::uint32_t interleave) const {
  const auto& [inverse, right_sides, gathered, results, solutions] = buffers;
  for (const InverseBuffers::LevelWindows& level : inverse.levels) {
    record_block_gather(commands, gather_, {inverse, right_sides, results, gathered}, level, right_side_count,
                        interleave);
    record_block_up(commands, up_, {inverse, gathered, results}, level, right_side_count);
  }
  for (auto level = inverse.levels.rbegin(); level != inverse.levels.rend(); ++level) {
    record_block_down(commands, down_, {inverse, results, solutions}, *level, right_side_count, interleave);
  }
}

}  // namespace bodyopt::vulkan
