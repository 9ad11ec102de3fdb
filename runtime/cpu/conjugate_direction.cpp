#include "runtime/cpu/dynamics_kernels.h"
#include "shaders/include/conjugate.h"

namespace bodyopt::cpu {

void conjugate_direction(std::span<const float> rho, std::span<const float> next_rho, std::span<const float> y,
                         std::span<const float> direction, std::span<float> next_direction) {
  const float beta = conjugate_ratio(next_rho[0], rho[0]);
#pragma omp parallel for schedule(static)
  for (std::size_t k = 0; k < direction.size(); ++k) next_direction[k] = y[k] + beta * direction[k];
}

}  // namespace bodyopt::cpu
