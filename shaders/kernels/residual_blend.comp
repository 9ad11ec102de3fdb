#version 450
#extension GL_GOOGLE_include_directive : require
// Residual stage: un-posed displacement of every vertex, the sum of its coefficients' basis vectors. Semantics:
// runtime/cpu/kernels.h.
#include "layout.h"

// Threads: push.vertex_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { ResidualBlendPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { uint blend_begin[]; };
layout(set = 0, binding = 1) readonly buffer B1 { BlendEntry blend[]; };
layout(set = 0, binding = 2) readonly buffer B2 { float coefficients[]; };
layout(set = 0, binding = 3) writeonly buffer B3 { float displacements[]; };

float number(uint entry, uint component, uint lane) {
  uint word = blend[entry].numbers[component * kLaneWords + lane / 4];
  return float(bitfieldExtract(int(word), int(8 * (lane % 4)), 8));
}

void main() {
  uint vertex = gl_GlobalInvocationID.x, frame = gl_GlobalInvocationID.y;
  if (vertex >= push.vertex_count) return;
  uint c = push.coefficient_count * frame;
  uint block = vertex / kBlockSize, lane = vertex % kBlockSize;
  precise float x = 0.0, y = 0.0, z = 0.0;
  for (uint e = blend_begin[block]; e < blend_begin[block + 1]; ++e) {
    uint head = blend[e].scale_coefficient;
    precise float weight = coefficients[c + (head >> 16)] * (unpackHalf2x16(head).x * kBlendFraction);
    x += weight * number(e, 0, lane);
    y += weight * number(e, 1, lane);
    z += weight * number(e, 2, lane);
  }
  uint at = 3 * (frame * push.vertex_count + vertex);
  displacements[at] = push.weight * x;
  displacements[at + 1] = push.weight * y;
  displacements[at + 2] = push.weight * z;
}
