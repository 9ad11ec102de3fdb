// Vulkan jiggle_advance: between the two solves of a step (shaders/kernels/jiggle_advance.comp).
#pragma once

#include "runtime/vulkan/commands.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

class JiggleAdvance {
 public:
  struct Buffers {
    BufferRange nodes, rotations, solution, local_displacement, local_velocity, next_displacement, next_velocity,
        right_side;
  };

  explicit JiggleAdvance(const Device& device);
  void record(Commands& commands, const Buffers& buffers, const JiggleStepPush& push) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
