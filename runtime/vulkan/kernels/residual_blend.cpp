#include "runtime/vulkan/kernels/residual_blend.h"

#include <array>

#include "residual_blend.spv.h"

namespace bodyopt::vulkan {

ResidualBlend::ResidualBlend(const Device& device) : kernel_(device, residual_blend_spv, sizeof(ResidualBlendPush)) {}

void ResidualBlend::record(Commands& commands, const Buffers& buffers, const ResidualBlendPush& push,
                           std::uint32_t frames) const {
  const std::array bindings = {buffers.blend_begin, buffers.blend, buffers.coefficients, buffers.displacements};
  commands.dispatch(kernel_, bindings, push, push.vertex_count, frames);
}

}  // namespace bodyopt::vulkan
