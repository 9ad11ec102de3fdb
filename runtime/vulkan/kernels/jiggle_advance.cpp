#include "runtime/vulkan/kernels/jiggle_advance.h"

#include <array>

#include "jiggle_advance.spv.h"

namespace bodyopt::vulkan {

JiggleAdvance::JiggleAdvance(const Device& device) : kernel_(device, jiggle_advance_spv, sizeof(JiggleStepPush)) {}

void JiggleAdvance::record(Commands& commands, const Buffers& buffers, const JiggleStepPush& push) const {
  const std::array bindings = {
      buffers.nodes,          buffers.rotations,         buffers.solution,      buffers.local_displacement,
      buffers.local_velocity, buffers.next_displacement, buffers.next_velocity, buffers.right_side};
  commands.dispatch(kernel_, bindings, push, push.node_count, 1);
}

}  // namespace bodyopt::vulkan
