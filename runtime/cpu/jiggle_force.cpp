#include <algorithm>

#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/parallel.h"
#include "shaders/include/jiggle.h"

namespace bodyopt::cpu {
namespace {

// Gradient of the shape function of a corner of a tet at rest.
void corner_gradient(const TetShape& shape, std::uint32_t corner, float (&gradient)[3]) {
  const float* inverse = shape.inverse_edges;
  for (std::size_t k = 0; k < 3; ++k) {
    gradient[k] = corner == 0 ? -(inverse[k] + inverse[3 + k] + inverse[6 + k]) : inverse[3 * (corner - 1) + k];
  }
}

}  // namespace

void jiggle_force(const TetTable& tets, const JiggleTable& jiggle, std::span<const float> rotations,
                  std::span<const float> tractions, std::span<const float> direction, std::span<float> product,
                  Executor& threads) {
  const std::size_t nodes = product.size() / 3;
  parallel_parts(threads, nodes, grain_of(1024), [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) {
      float sum[3] = {};
      float r[9];
      for (std::uint32_t k = jiggle.held_begin[node]; k < jiggle.held_begin[node + 1]; ++k) {
        const std::size_t other = jiggle.held_columns[k];
        float d[3], p[3];
        std::copy_n(&rotations[9 * other], 9, r);
        std::copy_n(&direction[3 * other], 3, d);
        turn(r, d, p);
        for (std::size_t i = 0; i < 3; ++i) sum[i] += jiggle.held_values[k] * p[i];
      }
      for (std::uint32_t k = tets.corner_begin[node]; k < tets.corner_begin[node + 1]; ++k) {
        const std::uint32_t tet = tets.corners[k] / 4;
        const float* traction = &tractions[std::size_t{9} * tet];
        float gradient[3];
        corner_gradient(tets.shapes[tet], tets.corners[k] % 4, gradient);
        for (std::size_t i = 0; i < 3; ++i) {
          sum[i] +=
              traction[3 * i] * gradient[0] + traction[3 * i + 1] * gradient[1] + traction[3 * i + 2] * gradient[2];
        }
      }
      float local[3];
      std::copy_n(&rotations[9 * node], 9, r);
      turn_back(r, sum, local);
      std::copy_n(local, 3, &product[3 * node]);
    }
  });
}

}  // namespace bodyopt::cpu
