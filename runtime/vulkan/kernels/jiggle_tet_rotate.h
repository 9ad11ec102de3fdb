// Vulkan jiggle_tet_rotate: rotation of every tet (shaders/kernels/jiggle_tet_rotate.comp).
#pragma once

#include "runtime/vulkan/commands.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

class JiggleTetRotate {
 public:
  struct Buffers {
    BufferRange tets, shapes, nodes, tet_rotations;
  };

  explicit JiggleTetRotate(const Device& device);
  void record(Commands& commands, const Buffers& buffers, const JiggleTetRotatePush& push) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
