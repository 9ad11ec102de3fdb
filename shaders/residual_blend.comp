#version 450
#extension GL_GOOGLE_include_directive : require
// Residual stage: un-posed displacement of every vertex, the sum of its coefficients' basis vectors. Semantics:
// runtime/cpu/kernels.h.
#include "layout.h"

layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { ResidualBlendPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { uint blend_begin[]; };
layout(set = 0, binding = 1) readonly buffer B1 { BlendEntry blend[]; };
layout(set = 0, binding = 2) readonly buffer B2 { float coefficients[]; };
layout(set = 0, binding = 3) writeonly buffer B3 { float displacements[]; };

void main() {
  uint vertex = gl_GlobalInvocationID.x, frame = gl_GlobalInvocationID.y;
  if (vertex >= push.vertex_count) return;
  uint c = push.coefficient_count * frame;
  precise float x = 0.0, y = 0.0, z = 0.0;
  for (uint e = blend_begin[vertex]; e < blend_begin[vertex + 1]; ++e) {
    BlendEntry entry = blend[e];
    float weight = coefficients[c + (entry.z_coefficient >> 16)];
    vec2 xy = unpackHalf2x16(entry.xy);
    x += weight * xy.x;
    y += weight * xy.y;
    z += weight * unpackHalf2x16(entry.z_coefficient).x;
  }
  uint at = 3 * (frame * push.vertex_count + vertex);
  displacements[at] = x;
  displacements[at + 1] = y;
  displacements[at + 2] = z;
}
