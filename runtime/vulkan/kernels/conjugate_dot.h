// Vulkan conjugate_dot: scalar product (shaders/kernels/conjugate_dot.comp).
#pragma once

#include "runtime/vulkan/commands.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

class ConjugateDot {
 public:
  struct Buffers {
    BufferRange a, b, sum;
  };

  explicit ConjugateDot(const Device& device);
  void record(Commands& commands, const Buffers& buffers, const ConjugatePush& push) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
