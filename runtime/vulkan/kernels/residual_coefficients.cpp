#include "runtime/vulkan/kernels/residual_coefficients.h"

#include <array>

#include "residual_coefficients.spv.h"

namespace bodyopt::vulkan {

ResidualCoefficients::ResidualCoefficients(const Device& device)
    : kernel_(device, residual_coefficients_spv, sizeof(ResidualCoefficientsPush)) {}

void ResidualCoefficients::record(Commands& commands, const Buffers& buffers, const ResidualCoefficientsPush& push,
                                  std::uint32_t frames) const {
  const std::array bindings = {buffers.regions,     buffers.coefficient_region,
                               buffers.weights,     buffers.rest_coefficients,
                               buffers.coordinates, buffers.kernels,
                               buffers.fades,       buffers.coefficients};
  commands.dispatch(kernel_, bindings, push, push.coefficient_count, frames);
}

}  // namespace bodyopt::vulkan
