#include "runtime/vulkan/kernels/residual_kernels.h"

#include <array>

#include "residual_kernels.spv.h"

namespace bodyopt::vulkan {

ResidualKernels::ResidualKernels(const Device& device)
    : kernel_(device, residual_kernels_spv, sizeof(ResidualKernelsPush)) {}

void ResidualKernels::record(Commands& commands, const Buffers& buffers, const ResidualKernelsPush& push,
                             std::uint32_t frames) const {
  const std::array bindings = {buffers.regions, buffers.centre_region, buffers.centres, buffers.coordinates,
                               buffers.kernels};
  commands.dispatch(kernel_, bindings, push, push.centre_count, frames);
}

}  // namespace bodyopt::vulkan
