#include "runtime/vulkan/kernels/jiggle_skin.h"

#include <array>

#include "jiggle_skin.spv.h"

namespace bodyopt::vulkan {

JiggleSkin::JiggleSkin(const Device& device) : kernel_(device, jiggle_skin_spv, sizeof(JiggleSkinPush)) {}

void JiggleSkin::record(Commands& commands, const Buffers& buffers, const JiggleSkinPush& push) const {
  const std::array bindings = {buffers.tets, buffers.skin, buffers.positions, buffers.displacement, buffers.moved};
  commands.dispatch(kernel_, bindings, push, push.vertex_count, 1);
}

}  // namespace bodyopt::vulkan
