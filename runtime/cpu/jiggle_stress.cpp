#include <algorithm>

#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/parallel.h"
#include "shaders/include/jiggle.h"

namespace bodyopt::cpu {
namespace {

// R_i direction_i.
void world_direction(std::span<const float> rotations, std::span<const float> direction, std::size_t node,
                     float (&p)[3]) {
  float r[9], d[3];
  std::copy_n(&rotations[9 * node], 9, r);
  std::copy_n(&direction[3 * node], 3, d);
  turn(r, d, p);
}

}  // namespace

void jiggle_stress(const TetTable& tets, const JiggleTable& jiggle, std::span<const float> rotations,
                   std::span<const float> tet_rotations, std::span<const float> direction, std::span<float> tractions,
                   Executor& threads) {
  parallel_parts(threads, tets.shapes.size(), grain_of(256), [&](std::size_t begin, std::size_t end) {
    for (std::size_t tet = begin; tet < end; ++tet) {
      const TetElasticity& elasticity = jiggle.elasticity[tet];
      const TetShape& shape = tets.shapes[tet];
      const float* inverse = shape.inverse_edges;
      float r[9], origin[3], corner[3];
      std::copy_n(&tet_rotations[9 * tet], 9, r);
      world_direction(rotations, direction, tets.tets[4 * tet], origin);
      float edges[9];  // R_e^T times the edges of p
      for (std::size_t j = 0; j < 3; ++j) {
        world_direction(rotations, direction, tets.tets[4 * tet + 1 + j], corner);
        float local[3];
        const float edge[3] = {corner[0] - origin[0], corner[1] - origin[1], corner[2] - origin[2]};
        turn_back(r, edge, local);
        for (std::size_t i = 0; i < 3; ++i) edges[3 * i + j] = local[i];
      }
      float gradient[9];
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
          gradient[3 * i + k] =
              edges[3 * i] * inverse[k] + edges[3 * i + 1] * inverse[3 + k] + edges[3 * i + 2] * inverse[6 + k];
        }
      }
      const float pressure = elasticity.lambda * (gradient[0] + gradient[4] + gradient[8]);
      for (std::size_t k = 0; k < 3; ++k) {  // column k of sigma
        float column[3], pull[3];
        for (std::size_t i = 0; i < 3; ++i) column[i] = elasticity.mu * (gradient[3 * i + k] + gradient[3 * k + i]);
        column[k] += pressure;
        turn(r, column, pull);
        for (std::size_t i = 0; i < 3; ++i) tractions[9 * tet + 3 * i + k] = shape.volume * pull[i];
      }
    }
  });
}

}  // namespace bodyopt::cpu
