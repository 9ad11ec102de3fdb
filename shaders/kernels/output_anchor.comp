#version 450
#extension GL_GOOGLE_include_directive : require
// Output stage: how anchors of attached meshes turn, and where they are. Semantics: runtime/cpu/attach_kernels.h.
#include "attach.h"
#include "rotation.h"

// Threads: push.anchor_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { OutputAnchorPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { AttachAnchor anchors[]; };
layout(set = 0, binding = 1) readonly buffer B1 { SurfacePoint points[]; };
layout(set = 0, binding = 2) readonly buffer B2 { AttachCorner corners[]; };
layout(set = 0, binding = 3) readonly buffer B3 { float stretches[]; };
layout(set = 0, binding = 4) readonly buffer B4 { float positions[]; };
layout(set = 0, binding = 5) readonly buffer B5 { float skinning[]; };
layout(set = 0, binding = 6) readonly buffer B6 { float origins[]; };
layout(set = 0, binding = 7) writeonly buffer B7 { float frames[]; };

void main() {
  uint number = gl_GlobalInvocationID.x, frame = gl_GlobalInvocationID.y;
  if (number >= push.anchor_count) return;
  AttachAnchor anchor = anchors[number];
  uint joint = 12 * (frame * push.joint_count + anchor.joint),
       to = kAnchorNumbers * (frame * push.anchor_count + number);
  float r[9], centre[3];
  if (anchor.point_begin == anchor.point_end) {
    for (uint i = 0; i < 3; ++i) {
      uint row = joint + 4 * i;
      for (uint j = 0; j < 3; ++j) r[3 * i + j] = skinning[row + j];
      precise float place =
          skinning[row] * anchor.x + skinning[row + 1] * anchor.y + skinning[row + 2] * anchor.z + skinning[row + 3];
      centre[i] = place + origins[4 * frame + i];
    }
  } else {
    uint x = 3 * push.vertex_count * frame, first = x + 3 * corners[points[anchor.point_begin].a].vertex;
    precise float stretch[9], away[3] = float[3](0.0, 0.0, 0.0);
    for (uint i = 0; i < 9; ++i) stretch[i] = kJointInAnchor * skinning[joint + 4 * (i / 3) + i % 3];
    for (uint k = anchor.point_begin; k < anchor.point_end; ++k) {
      SurfacePoint point = points[k];
      uint of[3] = uint[3](point.a, point.b, point.c);
      float weights[3] = float[3](point.wa, point.wb, point.wc);
      for (uint c = 0; c < 3; ++c) {
        uint at = x + 3 * corners[of[c]].vertex, motion = kStretchNumbers * (frame * push.corner_count + of[c]);
        for (uint i = 0; i < 3; ++i) away[i] += weights[c] * (positions[at + i] - positions[first + i]);
        for (uint i = 0; i < 9; ++i) stretch[i] += weights[c] * stretches[motion + i];
      }
    }
    rot(stretch, r);
    for (uint i = 0; i < 3; ++i) centre[i] = positions[first + i] + away[i];
  }
  for (uint i = 0; i < 9; ++i) frames[to + i] = r[i];
  for (uint i = 0; i < 3; ++i) frames[to + 9 + i] = centre[i];
}
