#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/parallel.h"
#include "shaders/include/layout.h"

namespace bodyopt::cpu {

void jiggle_kick(const JiggleKickPush& kick, std::span<const float> nodes, const JiggleMotion& before,
                 const JiggleMotionOut& after, Executor& threads) {
  const float origin_step[3] = {kick.origin_step_x, kick.origin_step_y, kick.origin_step_z};
  parallel_each(threads, nodes.size(), grain_of(16), [&](std::size_t k) {
    const float x = nodes[k];
    float u = 0, v = 0, node_velocity = 0;
    if (kick.start > 0) {
      u = before.displacement[k];
      v = before.velocity[k];
      node_velocity = (x - before.nodes[k] + origin_step[k % 3]) * kick.inverse_interval;
      if (kick.start > 1) v -= node_velocity - before.node_velocity[k];
    }
    after.displacement[k] = u;
    after.velocity[k] = v;
    after.nodes[k] = x;
    after.node_velocity[k] = node_velocity;
  });
}

}  // namespace bodyopt::cpu
