#include "runtime/basis/dynamics.h"
#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/parallel.h"
#include "shaders/include/jiggle.h"

namespace bodyopt::cpu {

void jiggle_skin(const TetTable& tets, std::span<const float> positions, std::span<const float> displacement,
                 float weight, std::span<float> moved, Executor& threads) {
  parallel_each(threads, tets.skin.size(), grain_of(16), [&](std::size_t vertex) {
    const TetPoint& point = tets.skin[vertex];
    const float* x = positions.data() + 3 * vertex;
    float* to = moved.data() + 3 * vertex;
    const float amount = weight * point.amount;
    if (amount == 0) {
      for (std::size_t i = 0; i < 3; ++i) to[i] = x[i];
      return;
    }
    const std::uint32_t* tet = tets.tets.data() + std::size_t{4} * point.tet;
    const auto corner = [&](std::size_t k) { return displacement.data() + std::size_t{3} * tet[k]; };
    const float *a = corner(0), *b = corner(1), *c = corner(2), *d = corner(3);
    float u[3];
    for (std::size_t i = 0; i < 3; ++i) u[i] = point.w0 * a[i] + point.w1 * b[i] + point.w2 * c[i] + point.w3 * d[i];
    const float squared = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
    const float taken = amount * limited_share(squared, tets.skin_limit[vertex]);
    for (std::size_t i = 0; i < 3; ++i) to[i] = x[i] + taken * u[i];
  });
}

}  // namespace bodyopt::cpu
