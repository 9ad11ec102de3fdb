#include "runtime/vulkan/residual_kernels.h"

#include <array>

#include "residual_kernels.spv.h"

namespace bodyopt::vulkan {

ResidualKernels::ResidualKernels(const Device& device)
    : kernel_(device, residual_kernels_spv, 6, sizeof(ResidualKernelsPush)) {}

void ResidualKernels::record(Commands& commands, const Buffers& buffers, const ResidualKernelsPush& push,
                             std::uint32_t frames) const {
  const std::array bindings = {buffers.regions, buffers.region_features, buffers.centre_region,
                               buffers.centres, buffers.features,        buffers.kernels};
  commands.dispatch(kernel_, bindings, push, push.centre_count, frames);
}

}  // namespace bodyopt::vulkan
