// Vulkan residual_blend: sparse blend of the coefficients to un-posed displacements
// (shaders/kernels/residual_blend.comp).
#pragma once

#include "runtime/vulkan/commands.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

class ResidualBlend {
 public:
  struct Buffers {
    BufferRange blend_begin, blend, coefficients, displacements;
  };

  explicit ResidualBlend(const Device& device);
  void record(Commands& commands, const Buffers& buffers, const ResidualBlendPush& push, std::uint32_t frames) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
