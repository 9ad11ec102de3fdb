// What strain_skin and pose_skin share: Direct Delta Mush of one vertex in the centred form, in the order of
// runtime/cpu/lane_ddm.h. The including kernel declares push, block_begin, block_joints, moments, vertices and skinning.
//
// Values are `precise`: a multiply and an add stay two roundings, so that a joint that moves as the base joint cancels
// exactly.
#include "rotation.h"

void transform_point(uint m, float p[3], out float result[3]) {
  for (uint i = 0; i < 3; ++i) {
    uint row = m + 4 * i;
    precise float value =
        skinning[row] * p[0] + skinning[row + 1] * p[1] + skinning[row + 2] * p[2] + skinning[row + 3];
    result[i] = value;
  }
}

// Posed position relative to the frame's origin. frame_skinning: offset of the frame's matrices.
void ddm_position(uint vertex, uint frame_skinning, float delta[3], out float position[3]) {
  uint block = vertex / kBlockSize, lane = vertex % kBlockSize;
  DdmVertex v = vertices[vertex - push.first_vertex];
  float centre[3] = float[3](v.centre_x, v.centre_y, v.centre_z);
  float base[3];
  transform_point(frame_skinning + 12 * v.base_joint, centre, base);
  precise float q[9] = float[9](0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
  precise float offset[3] = float[3](0.0, 0.0, 0.0);
  for (uint e = block_begin[block]; e < block_begin[block + 1]; ++e) {
    uint words = (e - push.first_entry) * kMomentWords * kBlockSize + lane;
    vec2 xx_xy = unpackHalf2x16(moments[words]);
    vec2 xz_yy = unpackHalf2x16(moments[words + kBlockSize]);
    vec2 yz_zz = unpackHalf2x16(moments[words + 2 * kBlockSize]);
    float sx = uintBitsToFloat(moments[words + 3 * kBlockSize]);
    float sy = uintBitsToFloat(moments[words + 4 * kBlockSize]);
    float sz = uintBitsToFloat(moments[words + 5 * kBlockSize]);
    float omega = uintBitsToFloat(moments[words + 6 * kBlockSize]);
    uint m = frame_skinning + 12 * block_joints[e];
    float image[3];
    transform_point(m, centre, image);
    for (int i = 0; i < 3; ++i) {
      float rx = skinning[m + 4 * i], ry = skinning[m + 4 * i + 1], rz = skinning[m + 4 * i + 2];
      precise float a = image[i] - base[i];
      q[3 * i] += rx * xx_xy.x + ry * xx_xy.y + rz * xz_yy.x + a * sx;
      q[3 * i + 1] += rx * xx_xy.y + ry * xz_yy.y + rz * yz_zz.x + a * sy;
      q[3 * i + 2] += rx * xz_yy.x + ry * yz_zz.x + rz * yz_zz.y + a * sz;
      offset[i] += omega * a + v.radius2 * (rx * sx + ry * sy + rz * sz);
    }
  }
  float r[9];
  rot(q, r);
  precise float d[3] = float[3](v.offset_x + delta[0], v.offset_y + delta[1], v.offset_z + delta[2]);
  for (int i = 0; i < 3; ++i) {
    precise float x = base[i] + offset[i] + (r[3 * i] * d[0] + r[3 * i + 1] * d[1] + r[3 * i + 2] * d[2]);
    position[i] = x;
  }
}
