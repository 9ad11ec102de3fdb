#include "runtime/vulkan/kernels/strain_measure.h"

#include <array>

#include "strain_measure.spv.h"

namespace bodyopt::vulkan {

StrainMeasure::StrainMeasure(const Device& device) : kernel_(device, strain_measure_spv, sizeof(StrainMeasurePush)) {}

void StrainMeasure::record(Commands& commands, const Buffers& buffers, const StrainMeasurePush& push,
                           std::uint32_t frames) const {
  const std::array bindings = {buffers.points, buffers.fibre_begin, buffers.rest_length, buffers.positions,
                               buffers.strains};
  commands.dispatch(kernel_, bindings, push, push.fibre_count, frames);
}

}  // namespace bodyopt::vulkan
