#include "runtime/cpu/attach_kernels.h"
#include "runtime/host/attach_tables.h"
#include "shaders/include/rotation.h"

namespace bodyopt::cpu {
namespace {

void on_joint(const AttachAnchor& anchor, const float* matrix, const float* origin, float (&r)[9], float (&centre)[3]) {
  for (std::size_t i = 0; i < 3; ++i) {
    const float* const row = matrix + 4 * i;
    for (std::size_t j = 0; j < 3; ++j) r[3 * i + j] = row[j];
    const float place = row[0] * anchor.x + row[1] * anchor.y + row[2] * anchor.z + row[3];
    centre[i] = place + origin[i];
  }
}

// Relative to one of its corners, which may be far from the origin.
void on_skin(const AttachTables& tables, const AttachAnchor& anchor, std::span<const float> stretches,
             std::span<const float> positions, const float* matrix, float (&r)[9], float (&centre)[3]) {
  const auto place = [&](std::uint32_t corner) { return &positions[3 * std::size_t{tables.corners[corner].vertex}]; };
  const float* const first = place(tables.points[anchor.point_begin].a);
  float stretch[kStretchNumbers], away[3] = {};
  for (std::size_t i = 0; i < kStretchNumbers; ++i) stretch[i] = kJointInAnchor * matrix[4 * (i / 3) + i % 3];
  for (std::uint32_t k = anchor.point_begin; k < anchor.point_end; ++k) {
    const SurfacePoint& point = tables.points[k];
    const std::uint32_t of[3] = {point.a, point.b, point.c};
    const float weights[3] = {point.wa, point.wb, point.wc};
    for (std::size_t c = 0; c < 3; ++c) {
      const float* const at = place(of[c]);
      const float* const motion = &stretches[std::size_t{kStretchNumbers} * of[c]];
      for (std::size_t i = 0; i < 3; ++i) away[i] += weights[c] * (at[i] - first[i]);
      for (std::size_t i = 0; i < kStretchNumbers; ++i) stretch[i] += weights[c] * motion[i];
    }
  }
  rot(stretch, r);
  for (std::size_t i = 0; i < 3; ++i) centre[i] = first[i] + away[i];
}

}  // namespace

void output_anchor(const AttachTables& tables, std::span<const float> stretches, std::span<const float> positions,
                   std::span<const float> skinning, const float* origin, std::span<float> frames) {
  for (std::size_t n = 0; n < tables.anchors.size(); ++n) {
    const AttachAnchor& anchor = tables.anchors[n];
    const float* const matrix = &skinning[12 * std::size_t{anchor.joint}];
    float r[9], centre[3];
    if (anchor.point_begin == anchor.point_end) {
      on_joint(anchor, matrix, origin, r, centre);
    } else {
      on_skin(tables, anchor, stretches, positions, matrix, r, centre);
    }
    float* const to = &frames[kAnchorNumbers * n];
    for (std::size_t i = 0; i < 9; ++i) to[i] = r[i];
    for (std::size_t i = 0; i < 3; ++i) to[9 + i] = centre[i];
  }
}

}  // namespace bodyopt::cpu
