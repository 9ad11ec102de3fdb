// Vulkan residual_kernels: Gaussian kernels of the coordinates (shaders/kernels/residual_kernels.comp).
#pragma once

#include "runtime/vulkan/commands.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

class ResidualKernels {
 public:
  struct Buffers {
    BufferRange regions, centre_region, centres, coordinates, kernels;
  };

  explicit ResidualKernels(const Device& device);
  void record(Commands& commands, const Buffers& buffers, const ResidualKernelsPush& push, std::uint32_t frames) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
