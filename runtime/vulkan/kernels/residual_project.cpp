#include "runtime/vulkan/kernels/residual_project.h"

#include <array>

#include "residual_project.spv.h"

namespace bodyopt::vulkan {

ResidualProject::ResidualProject(const Device& device)
    : kernel_(device, residual_project_spv, sizeof(ResidualProjectPush)) {}

void ResidualProject::record(Commands& commands, const Buffers& buffers, const ResidualProjectPush& push,
                             std::uint32_t frames) const {
  const std::array bindings = {buffers.regions,     buffers.region_features, buffers.coordinate_region,
                               buffers.projections, buffers.features,        buffers.coordinates};
  commands.dispatch(kernel_, bindings, push, push.coordinate_count, frames);
}

}  // namespace bodyopt::vulkan
