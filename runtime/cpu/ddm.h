// What strain_skin and pose_skin share: Direct Delta Mush of one vertex in the centred form.
//   a_j = M_j p - M_base p;  Q = sum_j (A_j S_j + a_j s_j^T);  t = M_base p + sum_j (omega_j a_j + r^2 A_j s_j);
//   R = rot(Q);  x = t + R (d + delta d)
#pragma once

#include <bit>
#include <cstdint>

#include "runtime/basis/basis.h"
#include "runtime/core/half.h"
#include "shaders/include/rotation.h"

namespace bodyopt::cpu {

// M (three rows of four) times a point.
inline void transform_point(const float* m, const float (&p)[3], float (&result)[3]) {
  for (int i = 0; i < 3; ++i) result[i] = m[4 * i] * p[0] + m[4 * i + 1] * p[1] + m[4 * i + 2] * p[2] + m[4 * i + 3];
}

// R (row-major) and t of a vertex, t relative to the frame's origin. skinning: J x 12 of the frame.
inline void ddm_frame(const DdmTable& ddm, std::uint32_t vertex, const float* skinning, float (&r)[9], float (&t)[3]) {
  const std::uint32_t block = vertex / kBlockSize, lane = vertex % kBlockSize;
  const DdmVertex& v = ddm.vertices[vertex];
  const float centre[3] = {v.centre_x, v.centre_y, v.centre_z};
  float base[3];
  transform_point(skinning + 12 * v.base_joint, centre, base);
  float q[9] = {};
  float offset[3] = {};
  for (std::uint32_t e = ddm.block_begin[block]; e < ddm.block_begin[block + 1]; ++e) {
    const std::uint32_t* words = ddm.moments.data() + std::size_t{e} * kMomentWords * kBlockSize + lane;
    const std::uint32_t w0 = words[0], w1 = words[kBlockSize], w2 = words[2 * kBlockSize];
    const float s[3] = {std::bit_cast<float>(words[3 * kBlockSize]), std::bit_cast<float>(words[4 * kBlockSize]),
                        std::bit_cast<float>(words[5 * kBlockSize])};
    const float omega = std::bit_cast<float>(words[6 * kBlockSize]);
    const float sxx = half_low(w0), sxy = half_high(w0), sxz = half_low(w1), syy = half_high(w1), syz = half_low(w2),
                szz = half_high(w2);
    const float* m = skinning + 12 * ddm.block_joints[e];
    float image[3];
    transform_point(m, centre, image);
    for (int i = 0; i < 3; ++i) {
      const float* row = m + 4 * i;
      const float a = image[i] - base[i];
      q[3 * i] += row[0] * sxx + row[1] * sxy + row[2] * sxz + a * s[0];
      q[3 * i + 1] += row[0] * sxy + row[1] * syy + row[2] * syz + a * s[1];
      q[3 * i + 2] += row[0] * sxz + row[1] * syz + row[2] * szz + a * s[2];
      offset[i] += omega * a + v.radius2 * (row[0] * s[0] + row[1] * s[1] + row[2] * s[2]);
    }
  }
  rot(q, r);
  for (int i = 0; i < 3; ++i) t[i] = base[i] + offset[i];
}

// Posed position of a vertex relative to the frame's origin. delta: un-posed, metres.
inline void ddm_position(const DdmTable& ddm, std::uint32_t vertex, const float* skinning, const float (&delta)[3],
                         float (&position)[3]) {
  float r[9], t[3];
  ddm_frame(ddm, vertex, skinning, r, t);
  const DdmVertex& v = ddm.vertices[vertex];
  const float d[3] = {v.offset_x + delta[0], v.offset_y + delta[1], v.offset_z + delta[2]};
  for (int i = 0; i < 3; ++i) {
    position[i] = t[i] + (r[3 * i] * d[0] + r[3 * i + 1] * d[1] + r[3 * i + 2] * d[2]);
  }
}

}  // namespace bodyopt::cpu
