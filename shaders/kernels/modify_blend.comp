#version 450
#extension GL_GOOGLE_include_directive : require
// Modify stage: what the modifiers add to the un-posed displacements, in place: most blocks have none. Semantics:
// runtime/cpu/kernels.h.
#include "layout.h"

// Threads: push.end_vertex - push.first_vertex
layout(local_size_x = kWorkgroupSize) in;
layout(constant_id = 0) const uint kFrames = 1;
layout(push_constant) uniform Constants { ModifyBlendPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { uint blend_begin[]; };
layout(set = 0, binding = 1) readonly buffer B1 { BlendEntry blend[]; };
layout(set = 0, binding = 2) readonly buffer B2 { float coefficients[]; };
layout(set = 0, binding = 3) buffer B3 { float displacements[]; };

#include "blend.glsl"

void main() {
  uint vertex = push.first_vertex + gl_GlobalInvocationID.x;
  uint frame = push.first_frame + kFrames * gl_GlobalInvocationID.y;
  if (vertex >= push.end_vertex || vertex >= push.vertex_count) return;
  uint block = vertex / kBlockSize;
  if (blend_begin[block] == blend_begin[block + 1]) return;
  float sum[kFrames][3];
  blend_sums(vertex, frame, push.component_count, sum);
  for (uint f = 0; f < kFrames; ++f) {
    uint at = 3 * ((frame + f) * push.vertex_count + vertex);
    for (int i = 0; i < 3; ++i) displacements[at + i] += sum[f][i];
  }
}
