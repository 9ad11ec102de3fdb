// Shared by strain_skin and pose_skin: Direct Delta Mush of one vertex in the centred form, in the order of
// runtime/cpu/lane_ddm.h. The including kernel declares kFrames, push, block_begin, block_joints, moments, vertices and
// skinning. That has a vec4 a row of a joint's matrix, which a software device fetches quicker than four numbers.
//
// Values are `precise`: a multiply and an add stay two roundings, so that a joint that moves as the base joint cancels
// exactly.
#include "rotation.h"

void transform_point(uint m, float p[3], out float result[3]) {
  for (uint i = 0; i < 3; ++i) {
    vec4 row = skinning[m + i];
    precise float value = row.x * p[0] + row.y * p[1] + row.z * p[2] + row.w;
    result[i] = value;
  }
}

// Posed positions of kFrames frames relative to their origins.
void ddm_positions(uint vertex, uint first_frame, float delta[kFrames][3], out float position[kFrames][3]) {
  uint block = vertex / kBlockSize, lane = vertex % kBlockSize, rows = 3 * push.joint_count;
  DdmVertex v = vertices[vertex - push.first_vertex];
  float centre[3] = float[3](v.centre_x, v.centre_y, v.centre_z);
  float base[kFrames][3];
  precise float q[kFrames][9];
  precise float offset[kFrames][3];
  for (uint f = 0; f < kFrames; ++f) {
    transform_point((first_frame + f) * rows + 3 * v.base_joint, centre, base[f]);
    for (int i = 0; i < 9; ++i) q[f][i] = 0.0;
    for (int i = 0; i < 3; ++i) offset[f][i] = 0.0;
  }
  for (uint e = block_begin[block]; e < block_begin[block + 1]; ++e) {
    uint words = (e - push.first_entry) * kMomentWords * kBlockSize + lane;
    vec2 xx_xy = unpackHalf2x16(moments[words]);
    vec2 xz_yy = unpackHalf2x16(moments[words + kBlockSize]);
    vec2 yz_zz = unpackHalf2x16(moments[words + 2 * kBlockSize]);
    float sx = uintBitsToFloat(moments[words + 3 * kBlockSize]);
    float sy = uintBitsToFloat(moments[words + 4 * kBlockSize]);
    float sz = uintBitsToFloat(moments[words + 5 * kBlockSize]);
    float omega = uintBitsToFloat(moments[words + 6 * kBlockSize]);
    uint joint = 3 * block_joints[e];
    for (uint f = 0; f < kFrames; ++f) {
      uint m = (first_frame + f) * rows + joint;
      float image[3];
      transform_point(m, centre, image);
      for (int i = 0; i < 3; ++i) {
        vec3 row = skinning[m + i].xyz;
        precise float a = image[i] - base[f][i];
        q[f][3 * i] += row.x * xx_xy.x + row.y * xx_xy.y + row.z * xz_yy.x + a * sx;
        q[f][3 * i + 1] += row.x * xx_xy.y + row.y * xz_yy.y + row.z * yz_zz.x + a * sy;
        q[f][3 * i + 2] += row.x * xz_yy.x + row.y * yz_zz.x + row.z * yz_zz.y + a * sz;
        offset[f][i] += omega * a + v.radius2 * (row.x * sx + row.y * sy + row.z * sz);
      }
    }
  }
  for (uint f = 0; f < kFrames; ++f) {
    float r[9];
    rot(q[f], r);
    precise float d[3] = float[3](v.offset_x + delta[f][0], v.offset_y + delta[f][1], v.offset_z + delta[f][2]);
    for (int i = 0; i < 3; ++i) {
      precise float x = base[f][i] + offset[f][i] + (r[3 * i] * d[0] + r[3 * i + 1] * d[1] + r[3 * i + 2] * d[2]);
      position[f][i] = x;
    }
  }
}
