// Vulkan block_down: the solution at a level's own slots (shaders/kernels/block_down.comp).
#pragma once

#include "runtime/vulkan/kernels/inverse_buffers.h"

namespace bodyopt::vulkan {

class BlockDown {
 public:
  struct Buffers {
    const InverseBuffers& inverse;
    BufferRange results, solutions;
  };

  explicit BlockDown(const Device& device);
  // One dispatch per window of the level.
  void record(Commands& commands, const Buffers& buffers, const InverseBuffers::Level& level,
              std::uint32_t right_side_count, std::uint32_t interleave) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
