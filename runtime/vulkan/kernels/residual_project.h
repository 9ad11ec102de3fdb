// Vulkan residual_project: the coordinates of the regions (shaders/kernels/residual_project.comp).
#pragma once

#include "runtime/vulkan/commands.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

class ResidualProject {
 public:
  struct Buffers {
    BufferRange regions, region_features, coordinate_region, projections, features, coordinates;
  };

  explicit ResidualProject(const Device& device);
  void record(Commands& commands, const Buffers& buffers, const ResidualProjectPush& push, std::uint32_t frames) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
