#include "runtime/cpu/attach_kernels.h"
#include "runtime/host/attach_tables.h"

namespace bodyopt::cpu {

void output_stretch(const AttachTables& tables, std::span<const float> positions, std::span<float> stretches) {
  for (std::size_t n = 0; n < tables.corners.size(); ++n) {
    const AttachCorner& corner = tables.corners[n];
    const float* const a = &positions[3 * std::size_t{corner.vertex}];
    float stretch[kStretchNumbers] = {}, normal[3] = {};
    for (std::uint32_t k = corner.fan_begin; k < corner.fan_end; ++k) {
      const AttachFan& fan = tables.fans[k];
      const float *const b = &positions[3 * std::size_t{fan.b}], *const c = &positions[3 * std::size_t{fan.c}];
      const float to_b[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, to_c[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
      add_fan(fan, to_b, to_c, stretch, normal);
    }
    finish_stretch(corner, normal, stretch);
    for (std::size_t i = 0; i < kStretchNumbers; ++i) stretches[kStretchNumbers * n + i] = stretch[i];
  }
}

}  // namespace bodyopt::cpu
