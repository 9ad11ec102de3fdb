#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/parallel.h"
#include "shaders/include/conjugate.h"

namespace bodyopt::cpu {

void conjugate_direction(std::span<const float> rho, std::span<const float> next_rho, std::span<const float> y,
                         std::span<const float> direction, std::span<float> next_direction, Executor& threads) {
  const float beta = conjugate_ratio(next_rho[0], rho[0]);
  parallel_parts(threads, direction.size(), grain_of(2), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) next_direction[k] = y[k] + beta * direction[k];
  });
}

}  // namespace bodyopt::cpu
