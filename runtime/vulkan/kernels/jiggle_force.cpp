#include "runtime/vulkan/kernels/jiggle_force.h"

#include <array>

#include "jiggle_force.spv.h"

namespace bodyopt::vulkan {

JiggleForce::JiggleForce(const Device& device) : kernel_(device, jiggle_force_spv, sizeof(JiggleForcePush)) {}

void JiggleForce::record(Commands& commands, const Buffers& buffers, const JiggleForcePush& push) const {
  const std::array bindings = {buffers.shapes,       buffers.corner_begin, buffers.corners,   buffers.held_begin,
                               buffers.held_columns, buffers.held_values,  buffers.rotations, buffers.tractions,
                               buffers.direction,    buffers.product};
  commands.dispatch(kernel_, bindings, push, push.node_count, 1);
}

}  // namespace bodyopt::vulkan
