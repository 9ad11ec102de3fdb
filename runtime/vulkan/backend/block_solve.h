// A block inverse's solve on the device: all levels up, then down (runtime/cpu/dynamics_kernels.h, block_solve).
#pragma once

#include "runtime/vulkan/kernels/windows.h"

namespace bodyopt::vulkan {

class BlockSolve {
 public:
  // gathered, results: scratch, right_side_count x slot_count floats each. right_sides and solutions may be one buffer.
  struct Buffers {
    const InverseBuffers& inverse;
    BufferRange right_sides, gathered, results, solutions;
  };

  explicit BlockSolve(const Device& device);
  void record(Commands& commands, const Buffers& buffers, std::uint32_t right_side_count,
              std::uint32_t interleave) const;

 private:
  BlockGather gather_;
  BlockUp up_;
  BlockDown down_;
};

}  // namespace bodyopt::vulkan
