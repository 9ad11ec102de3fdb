// Vulkan conjugate_direction: next direction of conjugate gradients (shaders/kernels/conjugate_direction.comp).
#pragma once

#include "runtime/vulkan/commands.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

class ConjugateDirection {
 public:
  struct Buffers {
    BufferRange rho, next_rho, y, direction, next_direction;
  };

  explicit ConjugateDirection(const Device& device);
  void record(Commands& commands, const Buffers& buffers, const ConjugatePush& push) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
