#include "runtime/cpu/deformation.h"
#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/parallel.h"
#include "shaders/include/rotation.h"

namespace bodyopt::cpu {

void jiggle_rotate(const TetTable& tets, std::span<const float> nodes, std::uint32_t frame_count,
                   std::span<float> rotations, Executor& threads) {
  const std::size_t count = tets.node_count();
  for (std::size_t f = 0; f < frame_count; ++f) {
    const float* x = nodes.data() + 3 * f * count;
    float* to = rotations.data() + 9 * f * count;
    parallel_for(threads, count, grain_of(4096), [&](std::size_t begin, std::size_t end) {
      for (std::size_t node = begin; node < end; ++node) {
        float sum[9] = {};
        for (std::uint32_t k = tets.corner_begin[node]; k < tets.corner_begin[node + 1]; ++k) {
          const std::uint32_t tet = tets.corners[k] / 4;
          float gradient[9];
          deformation_gradient(tets, tet, x, gradient);
          for (std::size_t i = 0; i < 9; ++i) sum[i] += tets.shapes[tet].volume * gradient[i];
        }
        float r[9];
        rot(sum, r);  // the same for the sum as for the mean
        for (std::size_t i = 0; i < 9; ++i) to[9 * node + i] = r[i];
      }
    });
  }
}

}  // namespace bodyopt::cpu
