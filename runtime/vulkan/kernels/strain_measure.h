// Vulkan strain_measure: length of every fibre over its rest length, minus one (shaders/kernels/strain_measure.comp).
#pragma once

#include "runtime/vulkan/commands.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

class StrainMeasure {
 public:
  struct Buffers {
    BufferRange points, fibre_begin, rest_length, positions, strains;
  };

  explicit StrainMeasure(const Device& device);
  void record(Commands& commands, const Buffers& buffers, const StrainMeasurePush& push, std::uint32_t frames) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
