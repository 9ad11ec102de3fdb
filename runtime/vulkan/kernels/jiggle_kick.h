// Vulkan jiggle_kick: inertia of the moving body (shaders/kernels/jiggle_kick.comp).
#pragma once

#include "runtime/vulkan/commands.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

class JiggleKick {
 public:
  struct Buffers {
    BufferRange nodes, displacement_before, velocity_before, nodes_before, node_velocity_before, displacement_after,
        velocity_after, nodes_after, node_velocity_after;
  };

  explicit JiggleKick(const Device& device);
  void record(Commands& commands, const Buffers& buffers, const JiggleKickPush& push) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
