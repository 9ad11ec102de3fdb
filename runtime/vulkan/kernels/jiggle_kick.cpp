#include "runtime/vulkan/kernels/jiggle_kick.h"

#include <array>

#include "jiggle_kick.spv.h"

namespace bodyopt::vulkan {

JiggleKick::JiggleKick(const Device& device) : kernel_(device, jiggle_kick_spv, sizeof(JiggleKickPush)) {}

void JiggleKick::record(Commands& commands, const Buffers& buffers, const JiggleKickPush& push) const {
  const std::array bindings = {buffers.nodes,          buffers.displacement_before,  buffers.velocity_before,
                               buffers.nodes_before,   buffers.node_velocity_before, buffers.displacement_after,
                               buffers.velocity_after, buffers.nodes_after,          buffers.node_velocity_after};
  commands.dispatch(kernel_, bindings, push, 3 * push.node_count, 1);
}

}  // namespace bodyopt::vulkan
