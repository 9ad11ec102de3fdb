// Vulkan jiggle_rotate: rotation of every node (shaders/kernels/jiggle_rotate.comp).
#pragma once

#include "runtime/vulkan/commands.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

class JiggleRotate {
 public:
  struct Buffers {
    BufferRange tets, shapes, corner_begin, corners, nodes, rotations;
  };

  explicit JiggleRotate(const Device& device);
  void record(Commands& commands, const Buffers& buffers, const JiggleRotatePush& push, std::uint32_t frames) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
