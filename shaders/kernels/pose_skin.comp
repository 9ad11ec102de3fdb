#version 450
#extension GL_GOOGLE_include_directive : require
// Pose stage: x = t + R (d + delta d) + origin. Semantics: runtime/cpu/kernels.h.
#include "layout.h"

// Threads: push.end_vertex - push.first_vertex
layout(local_size_x = kWorkgroupSize) in;
layout(constant_id = 0) const uint kFrames = 1;
layout(push_constant) uniform Constants { PoseSkinPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { uint block_begin[]; };
layout(set = 0, binding = 1) readonly buffer B1 { uint block_joints[]; };
layout(set = 0, binding = 2) readonly buffer B2 { uint moments[]; };
layout(set = 0, binding = 3) readonly buffer B3 { DdmVertex vertices[]; };
layout(set = 0, binding = 4) readonly buffer B4 { vec4 skinning[]; };
layout(set = 0, binding = 5) readonly buffer B5 { float origins[]; };
layout(set = 0, binding = 6) readonly buffer B6 { float displacements[]; };
layout(set = 0, binding = 7) writeonly buffer B7 { float positions[]; };

#include "ddm.glsl"

void main() {
  uint vertex = push.first_vertex + gl_GlobalInvocationID.x;
  uint frame = push.first_frame + kFrames * gl_GlobalInvocationID.y;
  if (vertex >= push.end_vertex || vertex >= push.vertex_count) return;
  float delta[kFrames][3], x[kFrames][3];
  for (uint f = 0; f < kFrames; ++f) {
    uint at = 3 * ((frame + f) * push.vertex_count + vertex);
    for (int i = 0; i < 3; ++i) delta[f][i] = displacements[at + i];
  }
  ddm_positions(vertex, frame, delta, x);
  for (uint f = 0; f < kFrames; ++f) {
    uint at = 3 * ((frame + f) * push.vertex_count + vertex);
    for (int i = 0; i < 3; ++i) positions[at + i] = x[f][i] + origins[4 * (frame + f) + i];
  }
}
