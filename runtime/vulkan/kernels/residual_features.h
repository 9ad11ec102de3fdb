// Vulkan residual_features: clamped, standardised features (shaders/kernels/residual_features.comp).
#pragma once

#include "runtime/vulkan/commands.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

class ResidualFeatures {
 public:
  struct Buffers {
    BufferRange ranges, joint_features, strains, controls, features, excess;
  };

  explicit ResidualFeatures(const Device& device);
  void record(Commands& commands, const Buffers& buffers, const ResidualFeaturesPush& push, std::uint32_t frames) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
