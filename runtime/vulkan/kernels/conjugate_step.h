// Vulkan conjugate_step: step of conjugate gradients (shaders/kernels/conjugate_step.comp).
#pragma once

#include "runtime/vulkan/commands.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

class ConjugateStep {
 public:
  struct Buffers {
    BufferRange rho, pq, direction, product, solution, residual, next_solution, next_residual;
  };

  explicit ConjugateStep(const Device& device);
  void record(Commands& commands, const Buffers& buffers, const ConjugatePush& push) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
