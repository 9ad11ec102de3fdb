#include "runtime/basis/dynamics.h"
#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/parallel.h"

namespace bodyopt::cpu {

void diffuse_gather(const DiffuseTable& diffuse, std::uint32_t surface_count, std::span<const float> nodes,
                    std::uint32_t frame_count, std::span<float> right_sides, Executor& threads) {
  const std::size_t count = diffuse.row_begin.size() - 1;
  for (std::size_t f = 0; f < frame_count; ++f) {
    const float* x = nodes.data() + 3 * f * count;
    float* to = right_sides.data() + 3 * f * count;
    parallel_parts(threads, count - surface_count, grain_of(64), [&](std::size_t begin, std::size_t end) {
      for (std::size_t node = surface_count + begin; node < surface_count + end; ++node) {
        float sum[3] = {};
        for (std::uint32_t e = diffuse.row_begin[node]; e < diffuse.row_begin[node + 1]; ++e) {
          const float* column = x + std::size_t{3} * diffuse.columns[e];
          for (std::size_t i = 0; i < 3; ++i) sum[i] += diffuse.values[e] * column[i];
        }
        for (std::size_t i = 0; i < 3; ++i) to[3 * node + i] = sum[i];
      }
    });
  }
}

}  // namespace bodyopt::cpu
