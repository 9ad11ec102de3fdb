// Shared by strain_skin and pose_skin: Direct Delta Mush of the vertices of a block in the centred form, in lanes.
//   Q = sum_j (A_j S_j + a_j s_j^T),  a_j = M_j p - M_base p.
//   R = rot(Q),  x = t + R (d + delta d),  t = M_base p + sum_j (omega_j a_j + r^2 A_j s_j).
#if defined(BODYOPT_LANE_DDM_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BODYOPT_LANE_DDM_H
#undef BODYOPT_LANE_DDM_H
#else
#define BODYOPT_LANE_DDM_H
#endif

#include "runtime/basis/basis.h"
#include "runtime/cpu/ddm_frames.h"
#include "runtime/cpu/lane_rotation.h"
#include "runtime/cpu/lanes.h"

HWY_BEFORE_NAMESPACE();
namespace bodyopt::cpu::HWY_NAMESPACE {

// The vertices of a group: DdmVertex, in lanes.
struct LaneVertices {
  Lanes centre[3], radius2, offset[3];
  LaneWords base_joint;
};

HWY_INLINE LaneVertices load_vertices(const DdmVertex* vertices) {
  static_assert(sizeof(DdmVertex) == 8 * sizeof(float));
  Lanes words[8];
  load_octets(&vertices->centre_x, words);
  return {{words[0], words[1], words[2]},
          words[3],
          {words[4], words[5], words[6]},
          hn::BitCast(LaneWordTag(), words[7].values)};
}

// M (three rows of four) times points.
HWY_INLINE void transform_points(const float* m, const Lanes (&p)[3], Lanes (&result)[3]) {
  for (int i = 0; i < 3; ++i) result[i] = m[4 * i] * p[0] + m[4 * i + 1] * p[1] + m[4 * i + 2] * p[2] + m[4 * i + 3];
}

// M_base p. The base joint of each vertex is one of the block's.
HWY_INLINE void transform_by_base(const DdmTable& ddm, std::uint32_t block, const float* skinning,
                                  const LaneVertices& v, Lanes (&base)[3]) {
  for (Lanes& x : base) x = 0.0f;
  for (std::uint32_t e = ddm.block_begin[block]; e < ddm.block_begin[block + 1]; ++e) {
    const std::uint32_t joint = ddm.block_joints[e];
    const auto is_base = hn::Eq(v.base_joint, hn::Set(LaneWordTag(), joint));
    if (hn::AllFalse(LaneWordTag(), is_base)) continue;
    Lanes image[3];
    transform_points(skinning + 12 * joint, v.centre, image);
    const LaneMask mask{hn::RebindMask(LaneTag(), is_base)};
    for (int i = 0; i < 3; ++i) base[i] = select(mask, image[i], base[i]);
  }
}

// R (row-major) and t, relative to the frame's origin, of the lanes from `lane` on. skinning: J x 12 of the frame.
HWY_INLINE void ddm_frames(const DdmTable& ddm, std::uint32_t block, std::uint32_t lane, const float* skinning,
                           const LaneVertices& v, Lanes (&r)[9], Lanes (&t)[3]) {
  Lanes base[3], q[9], offset[3];
  transform_by_base(ddm, block, skinning, v, base);
  for (Lanes& x : q) x = 0.0f;
  for (Lanes& x : offset) x = 0.0f;
  for (std::uint32_t e = ddm.block_begin[block]; e < ddm.block_begin[block + 1]; ++e) {
    const std::uint32_t* words = ddm.moments.data() + std::size_t{e} * kMomentWords * kBlockSize + lane;
    const auto word = [&](std::uint32_t w) HWY_ATTR { return load_lane_words(words + w * kBlockSize); };
    const Lanes s[3] = {lanes_from_bits(word(3)), lanes_from_bits(word(4)), lanes_from_bits(word(5))};
    const Lanes omega = lanes_from_bits(word(6));
    const LaneWords xx_xy = word(0), xz_yy = word(1), yz_zz = word(2);
    const Lanes sxx = lanes_from_low_halves(xx_xy), sxy = lanes_from_high_halves(xx_xy);
    const Lanes sxz = lanes_from_low_halves(xz_yy), syy = lanes_from_high_halves(xz_yy);
    const Lanes syz = lanes_from_low_halves(yz_zz), szz = lanes_from_high_halves(yz_zz);
    const float* m = skinning + 12 * ddm.block_joints[e];
    Lanes image[3];
    transform_points(m, v.centre, image);
    for (int i = 0; i < 3; ++i) {
      const float* row = m + 4 * i;
      const Lanes a = image[i] - base[i];
      q[3 * i] += row[0] * sxx + row[1] * sxy + row[2] * sxz + a * s[0];
      q[3 * i + 1] += row[0] * sxy + row[1] * syy + row[2] * syz + a * s[1];
      q[3 * i + 2] += row[0] * sxz + row[1] * syz + row[2] * szz + a * s[2];
      offset[i] += omega * a + v.radius2 * (row[0] * s[0] + row[1] * s[1] + row[2] * s[2]);
    }
  }
  rot(q, r);
  for (int i = 0; i < 3; ++i) t[i] = base[i] + offset[i];
}

// The frames of a group of lanes in those of its block (runtime/cpu/ddm_frames.h).
HWY_INLINE void store_frames(const Lanes (&r)[9], const Lanes (&t)[3], float* to) {
  for (std::uint32_t i = 0; i < 9; ++i) store_lanes(r[i], to + i * kBlockSize);
  for (std::uint32_t i = 0; i < 3; ++i) store_lanes(t[i], to + (9 + i) * kBlockSize);
}
HWY_INLINE void load_frames(const float* from, Lanes (&r)[9], Lanes (&t)[3]) {
  for (std::uint32_t i = 0; i < 9; ++i) r[i] = load_lanes(from + i * kBlockSize);
  for (std::uint32_t i = 0; i < 3; ++i) t[i] = load_lanes(from + (9 + i) * kBlockSize);
}

// Posed positions relative to the frame's origin. delta: un-posed, metres.
HWY_INLINE void ddm_positions(const Lanes (&r)[9], const Lanes (&t)[3], const LaneVertices& v, const Lanes (&delta)[3],
                              Lanes (&positions)[3]) {
  const Lanes d[3] = {v.offset[0] + delta[0], v.offset[1] + delta[1], v.offset[2] + delta[2]};
  for (int i = 0; i < 3; ++i) {
    positions[i] = t[i] + (r[3 * i] * d[0] + r[3 * i + 1] * d[1] + r[3 * i + 2] * d[2]);
  }
}

}  // namespace bodyopt::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
