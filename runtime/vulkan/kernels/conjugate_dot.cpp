#include "runtime/vulkan/kernels/conjugate_dot.h"

#include <array>

#include "conjugate_dot.spv.h"

namespace bodyopt::vulkan {

ConjugateDot::ConjugateDot(const Device& device) : kernel_(device, conjugate_dot_spv, sizeof(ConjugatePush)) {}

void ConjugateDot::record(Commands& commands, const Buffers& buffers, const ConjugatePush& push) const {
  const std::array bindings = {buffers.a, buffers.b, buffers.sum};
  commands.dispatch(kernel_, bindings, push, kWorkgroupSize, 1);
}

}  // namespace bodyopt::vulkan
