#include "runtime/vulkan/kernels/conjugate_step.h"

#include <array>

#include "conjugate_step.spv.h"

namespace bodyopt::vulkan {

ConjugateStep::ConjugateStep(const Device& device) : kernel_(device, conjugate_step_spv, sizeof(ConjugatePush)) {}

void ConjugateStep::record(Commands& commands, const Buffers& buffers, const ConjugatePush& push) const {
  const std::array bindings = {buffers.rho,      buffers.pq,       buffers.direction,     buffers.product,
                               buffers.solution, buffers.residual, buffers.next_solution, buffers.next_residual};
  commands.dispatch(kernel_, bindings, push, push.count, 1);
}

}  // namespace bodyopt::vulkan
