#include "runtime/vulkan/kernels/jiggle_end.h"

#include <array>

#include "jiggle_end.spv.h"

namespace bodyopt::vulkan {

JiggleEnd::JiggleEnd(const Device& device) : kernel_(device, jiggle_end_spv, sizeof(JiggleStepPush)) {}

void JiggleEnd::record(Commands& commands, const Buffers& buffers, const JiggleStepPush& push) const {
  const std::array bindings = {buffers.rotations, buffers.solution, buffers.local_displacement, buffers.displacement,
                               buffers.velocity};
  commands.dispatch(kernel_, bindings, push, push.node_count, 1);
}

}  // namespace bodyopt::vulkan
