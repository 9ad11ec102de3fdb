#include <algorithm>

#include "runtime/basis/dynamics.h"
#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/parallel.h"
#include "shaders/include/jiggle.h"

namespace bodyopt::cpu {
namespace {

// How active the muscle of a node is, 0..1.
float activation(const JiggleNode& node, std::span<const float> strains, std::span<const float> controls) {
  float contracted = 0;
  if (node.fibre_count > 0) {
    float sum = 0;
    for (std::uint32_t f = 0; f < node.fibre_count; ++f) sum += strains[node.first_fibre + f];
    contracted = std::clamp(-sum / static_cast<float>(node.fibre_count) / kFullActivationStrain, 0.0f, 1.0f);
  }
  float flexed = 0;
  if (node.control < controls.size()) flexed = std::clamp(controls[node.control], 0.0f, 1.0f);
  return contracted + (1 - contracted) * flexed;
}

}  // namespace

void jiggle_begin(const JiggleTable& jiggle, const JiggleStepPush& step, std::span<const float> rotations,
                  std::span<const float> strains, std::span<const float> controls, std::span<const float> displacement,
                  std::span<const float> velocity, std::span<float> local_displacement, std::span<float> local_velocity,
                  std::span<float> right_side, Executor& threads) {
  parallel_each(threads, jiggle.nodes.size(), grain_of(64), [&](std::size_t n) {
    const JiggleNode& node = jiggle.nodes[n];
    float r[9], world_u[3], world_v[3], u[3], v[3], b[3];
    std::copy_n(&rotations[9 * n], 9, r);
    std::copy_n(&displacement[3 * n], 3, world_u);
    std::copy_n(&velocity[3 * n], 3, world_v);
    turn_back(r, world_u, u);
    turn_back(r, world_v, v);
    const float pull = step.duration * (node.stiffening * activation(node, strains, controls));
    const float drag = 1 + step.duration * pull;
    for (int i = 0; i < 3; ++i) v[i] = (v[i] - pull * u[i]) / drag;
    node_right_side(node, step, r, u, v, b);
    std::copy_n(u, 3, &local_displacement[3 * n]);
    std::copy_n(v, 3, &local_velocity[3 * n]);
    std::copy_n(b, 3, &right_side[3 * n]);
  });
}

}  // namespace bodyopt::cpu
