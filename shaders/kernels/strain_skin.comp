#version 450
#extension GL_GOOGLE_include_directive : require
// Strain stage: DDM base positions (no un-posed displacement), relative to the frame's origin, of the vertices under
// fibres. Semantics: runtime/cpu/kernels.h.
#include "layout.h"

// Threads: push.strain_vertex_count
layout(local_size_x = kWorkgroupSize) in;
layout(constant_id = 0) const uint kFrames = 1;
layout(push_constant) uniform Constants { StrainSkinPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { uint block_begin[]; };
layout(set = 0, binding = 1) readonly buffer B1 { uint block_joints[]; };
layout(set = 0, binding = 2) readonly buffer B2 { uint moments[]; };
layout(set = 0, binding = 3) readonly buffer B3 { DdmVertex vertices[]; };
layout(set = 0, binding = 4) readonly buffer B4 { vec4 skinning[]; };
layout(set = 0, binding = 5) readonly buffer B5 { uint strain_vertices[]; };
layout(set = 0, binding = 6) writeonly buffer B6 { float positions[]; };

#include "ddm.glsl"

void main() {
  uint k = gl_GlobalInvocationID.x, frame = push.first_frame + kFrames * gl_GlobalInvocationID.y;
  if (k >= push.strain_vertex_count) return;
  uint vertex = strain_vertices[k];
  if (vertex < push.first_vertex || vertex >= push.end_vertex) return;
  float no_delta[kFrames][3], x[kFrames][3];
  for (uint f = 0; f < kFrames; ++f) {
    for (int i = 0; i < 3; ++i) no_delta[f][i] = 0.0;
  }
  ddm_positions(vertex, frame, no_delta, x);
  for (uint f = 0; f < kFrames; ++f) {
    uint at = 3 * ((frame + f) * push.strain_vertex_count + k);
    for (int i = 0; i < 3; ++i) positions[at + i] = x[f][i];
  }
}
