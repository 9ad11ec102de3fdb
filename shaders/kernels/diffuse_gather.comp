#version 450
#extension GL_GOOGLE_include_directive : require
// Diffuse stage: -L_IB X_B of every node that is not on the skin. Semantics: runtime/cpu/dynamics_kernels.h.
#include "layout.h"

// Threads: push.node_count - push.surface_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { DiffuseGatherPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { uint row_begin[]; };
layout(set = 0, binding = 1) readonly buffer B1 { uint columns[]; };
layout(set = 0, binding = 2) readonly buffer B2 { float values[]; };
layout(set = 0, binding = 3) readonly buffer B3 { float nodes[]; };
layout(set = 0, binding = 4) writeonly buffer B4 { float right_sides[]; };

void main() {
  uint node = push.surface_count + gl_GlobalInvocationID.x, frame = gl_GlobalInvocationID.y;
  if (node >= push.node_count) return;
  uint x = 3 * push.node_count * frame;
  precise float sum[3] = float[3](0.0, 0.0, 0.0);
  for (uint e = row_begin[node]; e < row_begin[node + 1]; ++e) {
    uint column = x + 3 * columns[e];
    for (uint i = 0; i < 3; ++i) sum[i] += values[e] * nodes[column + i];
  }
  for (uint i = 0; i < 3; ++i) right_sides[x + 3 * node + i] = sum[i];
}
