#include "runtime/vulkan/kernels/diffuse_gather.h"

#include <array>

#include "diffuse_gather.spv.h"

namespace bodyopt::vulkan {

DiffuseGather::DiffuseGather(const Device& device) : kernel_(device, diffuse_gather_spv, sizeof(DiffuseGatherPush)) {}

void DiffuseGather::record(Commands& commands, const Buffers& buffers, const DiffuseGatherPush& push,
                           std::uint32_t frames) const {
  const std::array bindings = {buffers.row_begin, buffers.columns, buffers.values, buffers.nodes, buffers.right_sides};
  commands.dispatch(kernel_, bindings, push, push.node_count - push.surface_count, frames);
}

}  // namespace bodyopt::vulkan
