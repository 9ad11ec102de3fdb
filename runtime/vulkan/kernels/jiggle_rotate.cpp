#include "runtime/vulkan/kernels/jiggle_rotate.h"

#include <array>

#include "jiggle_rotate.spv.h"

namespace bodyopt::vulkan {

JiggleRotate::JiggleRotate(const Device& device) : kernel_(device, jiggle_rotate_spv, sizeof(JiggleRotatePush)) {}

void JiggleRotate::record(Commands& commands, const Buffers& buffers, const JiggleRotatePush& push,
                          std::uint32_t frames) const {
  const std::array bindings = {buffers.tets,    buffers.shapes, buffers.corner_begin,
                               buffers.corners, buffers.nodes,  buffers.rotations};
  commands.dispatch(kernel_, bindings, push, push.node_count, frames);
}

}  // namespace bodyopt::vulkan
