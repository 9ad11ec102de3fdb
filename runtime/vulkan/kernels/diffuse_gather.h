// Vulkan diffuse_gather: right sides of the nodes that are not on the skin (shaders/kernels/diffuse_gather.comp).
#pragma once

#include "runtime/vulkan/commands.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

class DiffuseGather {
 public:
  struct Buffers {
    BufferRange row_begin, columns, values, nodes, right_sides;
  };

  explicit DiffuseGather(const Device& device);
  void record(Commands& commands, const Buffers& buffers, const DiffuseGatherPush& push, std::uint32_t frames) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
