// Vulkan jiggle_stress: what every tet pulls with (shaders/kernels/jiggle_stress.comp).
#pragma once

#include "runtime/vulkan/commands.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

class JiggleStress {
 public:
  struct Buffers {
    BufferRange tets, shapes, elasticity, rotations, tet_rotations, direction, tractions;
  };

  explicit JiggleStress(const Device& device);
  void record(Commands& commands, const Buffers& buffers, const JiggleStressPush& push) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
