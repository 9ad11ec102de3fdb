#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/parallel.h"
#include "shaders/include/conjugate.h"

namespace bodyopt::cpu {

void conjugate_step(std::span<const float> rho, std::span<const float> pq, std::span<const float> direction,
                    std::span<const float> product, std::span<const float> solution, std::span<const float> residual,
                    std::span<float> next_solution, std::span<float> next_residual, Executor& threads) {
  const float alpha = conjugate_ratio(rho[0], pq[0]);
  parallel_parts(threads, direction.size(), grain_of(4), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      next_solution[k] = solution[k] + alpha * direction[k];
      next_residual[k] = residual[k] - alpha * product[k];
    }
  });
}

}  // namespace bodyopt::cpu
