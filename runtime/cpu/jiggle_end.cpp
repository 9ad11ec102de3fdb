#include <algorithm>
#include <cmath>

#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/parallel.h"
#include "shaders/include/jiggle.h"

namespace bodyopt::cpu {

void jiggle_end(const JiggleStepPush& step, std::span<const float> rotations, std::span<const float> solution,
                std::span<const float> local_displacement, std::span<float> displacement, std::span<float> velocity,
                Executor& threads) {
  const std::size_t nodes = displacement.size() / 3;
  parallel_each(threads, nodes, grain_of(32), [&](std::size_t n) {
    float r[9], u[3], v[3], world_u[3], world_v[3];
    std::copy_n(&rotations[9 * n], 9, r);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t k = 3 * n + i;
      u[i] = step.u_from_u * local_displacement[k] + step.u_from_z * solution[k];
      v[i] = step.v_from_u * local_displacement[k] + step.v_from_z * solution[k];
    }
    turn(r, u, world_u);
    turn(r, v, world_v);
    for (std::size_t i = 0; i < 3; ++i) {
      displacement[3 * n + i] = std::abs(world_u[i]) < kStill ? 0.0f : world_u[i];
      velocity[3 * n + i] = std::abs(world_v[i]) < kStill ? 0.0f : world_v[i];
    }
  });
}

}  // namespace bodyopt::cpu
