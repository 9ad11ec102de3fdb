// Vulkan residual_coefficients: dense products per region (shaders/kernels/residual_coefficients.comp).
#pragma once

#include "runtime/vulkan/commands.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

class ResidualCoefficients {
 public:
  struct Buffers {
    BufferRange regions, coefficient_region, weights, rest_coefficients, coordinates, kernels, fades, coefficients;
  };

  explicit ResidualCoefficients(const Device& device);
  void record(Commands& commands, const Buffers& buffers, const ResidualCoefficientsPush& push,
              std::uint32_t frames) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
