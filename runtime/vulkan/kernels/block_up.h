// Vulkan block_up: what a level hands up and down (shaders/kernels/block_up.comp).
#pragma once

#include "runtime/vulkan/kernels/inverse_buffers.h"

namespace bodyopt::vulkan {

class BlockUp {
 public:
  struct Buffers {
    const InverseBuffers& inverse;
    BufferRange gathered, results;
  };

  explicit BlockUp(const Device& device);
  // One dispatch per window of the level.
  void record(Commands& commands, const Buffers& buffers, const InverseBuffers::Level& level,
              std::uint32_t right_side_count) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
