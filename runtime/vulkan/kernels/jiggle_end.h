// Vulkan jiggle_end: end of a step (shaders/kernels/jiggle_end.comp).
#pragma once

#include "runtime/vulkan/commands.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

class JiggleEnd {
 public:
  struct Buffers {
    BufferRange rotations, solution, local_displacement, displacement, velocity;
  };

  explicit JiggleEnd(const Device& device);
  void record(Commands& commands, const Buffers& buffers, const JiggleStepPush& push) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
