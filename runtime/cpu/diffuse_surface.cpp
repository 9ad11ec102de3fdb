#include "runtime/basis/dynamics.h"
#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/parallel.h"

namespace bodyopt::cpu {

void diffuse_surface(const TetTable& tets, std::span<const float> positions, std::span<const float> origins,
                     std::uint32_t frame_count, std::span<float> nodes, Executor& threads) {
  const std::size_t vertices = frame_count == 0 ? 0 : positions.size() / (std::size_t{3} * frame_count);
  for (std::size_t f = 0; f < frame_count; ++f) {
    const float* x = positions.data() + 3 * f * vertices;
    const float* origin = origins.data() + 4 * f;
    float* to = nodes.data() + 3 * f * tets.node_count();
    parallel_each(threads, tets.surface.size(), grain_of(16), [&](std::size_t node) {
      const SurfacePoint& point = tets.surface[node];
      const float *a = x + std::size_t{3} * point.a, *b = x + std::size_t{3} * point.b,
                  *c = x + std::size_t{3} * point.c;
      // The origin is subtracted first: far from it, the rounding of the weights would show in their sum.
      for (std::size_t i = 0; i < 3; ++i) {
        to[3 * node + i] =
            point.wa * (a[i] - origin[i]) + point.wb * (b[i] - origin[i]) + point.wc * (c[i] - origin[i]);
      }
    });
  }
}

}  // namespace bodyopt::cpu
