#include <algorithm>

#include "runtime/basis/dynamics.h"
#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/parallel.h"
#include "shaders/include/jiggle.h"

namespace bodyopt::cpu {

void jiggle_advance(const JiggleTable& jiggle, const JiggleStepPush& step, std::span<const float> rotations,
                    std::span<const float> solution, std::span<const float> local_displacement,
                    std::span<const float> local_velocity, std::span<float> next_displacement,
                    std::span<float> next_velocity, std::span<float> right_side, Executor& threads) {
  parallel_each(threads, jiggle.nodes.size(), grain_of(32), [&](std::size_t n) {
    float r[9], u[3], v[3], b[3];
    std::copy_n(&rotations[9 * n], 9, r);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t k = 3 * n + i;
      u[i] = step.u_from_u * local_displacement[k] + step.u_from_z * solution[k];
      v[i] = step.v_from_u * local_displacement[k] + step.v_from_z * solution[k] + step.v_from_v * local_velocity[k];
    }
    node_right_side(jiggle.nodes[n], step, r, u, v, b);
    std::copy_n(u, 3, &next_displacement[3 * n]);
    std::copy_n(v, 3, &next_velocity[3 * n]);
    std::copy_n(b, 3, &right_side[3 * n]);
  });
}

}  // namespace bodyopt::cpu
