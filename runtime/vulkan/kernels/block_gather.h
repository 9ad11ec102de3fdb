// Vulkan block_gather: what every slot of a level starts from (shaders/kernels/block_gather.comp).
#pragma once

#include "runtime/vulkan/kernels/inverse_buffers.h"

namespace bodyopt::vulkan {

class BlockGather {
 public:
  struct Buffers {
    const InverseBuffers& inverse;
    BufferRange right_sides, results, gathered;
  };

  explicit BlockGather(const Device& device);
  void record(Commands& commands, const Buffers& buffers, const InverseBuffers::Level& level,
              std::uint32_t right_side_count, std::uint32_t interleave) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
