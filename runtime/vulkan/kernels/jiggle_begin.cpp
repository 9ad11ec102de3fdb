#include "runtime/vulkan/kernels/jiggle_begin.h"

#include <array>

#include "jiggle_begin.spv.h"

namespace bodyopt::vulkan {

JiggleBegin::JiggleBegin(const Device& device) : kernel_(device, jiggle_begin_spv, sizeof(JiggleStepPush)) {}

void JiggleBegin::record(Commands& commands, const Buffers& buffers, const JiggleStepPush& push) const {
  const std::array bindings = {
      buffers.nodes,    buffers.rotations,          buffers.strains,        buffers.controls,  buffers.displacement,
      buffers.velocity, buffers.local_displacement, buffers.local_velocity, buffers.right_side};
  commands.dispatch(kernel_, bindings, push, push.node_count, 1);
}

}  // namespace bodyopt::vulkan
