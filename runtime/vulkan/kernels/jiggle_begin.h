// Vulkan jiggle_begin: begin of a step (shaders/kernels/jiggle_begin.comp).
#pragma once

#include "runtime/vulkan/commands.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

class JiggleBegin {
 public:
  struct Buffers {
    BufferRange nodes, rotations, strains, controls, displacement, velocity, local_displacement, local_velocity,
        right_side;
  };

  explicit JiggleBegin(const Device& device);
  void record(Commands& commands, const Buffers& buffers, const JiggleStepPush& push) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
