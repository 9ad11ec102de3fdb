#include <algorithm>

#include "runtime/cpu/deformation.h"
#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/parallel.h"
#include "shaders/include/rotation.h"

namespace bodyopt::cpu {

void jiggle_tet_rotate(const TetTable& tets, std::span<const float> nodes, std::span<float> tet_rotations,
                       Executor& threads) {
  parallel_parts(threads, tets.shapes.size(), grain_of(512), [&](std::size_t begin, std::size_t end) {
    for (std::size_t tet = begin; tet < end; ++tet) {
      float f[9], r[9];
      deformation_gradient(tets, tet, nodes.data(), f);
      rot(f, r);
      std::copy_n(r, 9, &tet_rotations[9 * tet]);
    }
  });
}

}  // namespace bodyopt::cpu
