// Vulkan jiggle_force: product with the corotated operator (shaders/kernels/jiggle_force.comp).
#pragma once

#include "runtime/vulkan/commands.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

class JiggleForce {
 public:
  struct Buffers {
    BufferRange shapes, corner_begin, corners, held_begin, held_columns, held_values, rotations, tractions, direction,
        product;
  };

  explicit JiggleForce(const Device& device);
  void record(Commands& commands, const Buffers& buffers, const JiggleForcePush& push) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
