#include "runtime/vulkan/kernels/jiggle_tet_rotate.h"

#include <array>

#include "jiggle_tet_rotate.spv.h"

namespace bodyopt::vulkan {

JiggleTetRotate::JiggleTetRotate(const Device& device)
    : kernel_(device, jiggle_tet_rotate_spv, sizeof(JiggleTetRotatePush)) {}

void JiggleTetRotate::record(Commands& commands, const Buffers& buffers, const JiggleTetRotatePush& push) const {
  const std::array bindings = {buffers.tets, buffers.shapes, buffers.nodes, buffers.tet_rotations};
  commands.dispatch(kernel_, bindings, push, push.tet_count, 1);
}

}  // namespace bodyopt::vulkan
