#include "runtime/vulkan/kernels/conjugate_direction.h"

#include <array>

#include "conjugate_direction.spv.h"

namespace bodyopt::vulkan {

ConjugateDirection::ConjugateDirection(const Device& device)
    : kernel_(device, conjugate_direction_spv, sizeof(ConjugatePush)) {}

void ConjugateDirection::record(Commands& commands, const Buffers& buffers, const ConjugatePush& push) const {
  const std::array bindings = {buffers.rho, buffers.next_rho, buffers.y, buffers.direction, buffers.next_direction};
  commands.dispatch(kernel_, bindings, push, push.count, 1);
}

}  // namespace bodyopt::vulkan
