// Vulkan diffuse_surface: nodes on the skin, where the skin carries them (shaders/kernels/diffuse_surface.comp).
#pragma once

#include "runtime/vulkan/commands.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

class DiffuseSurface {
 public:
  struct Buffers {
    BufferRange surface, positions, origins, nodes;
  };

  explicit DiffuseSurface(const Device& device);
  void record(Commands& commands, const Buffers& buffers, const DiffuseSurfacePush& push, std::uint32_t frames) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
