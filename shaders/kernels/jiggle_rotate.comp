#version 450
#extension GL_GOOGLE_include_directive : require
// Jiggle stage: rotation of every node, that of the volume-weighted deformation gradients of its tets. Semantics:
// runtime/cpu/dynamics_kernels.h.
#include "layout.h"
#include "rotation.h"

// Threads: push.node_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { JiggleRotatePush push; };
layout(set = 0, binding = 0) readonly buffer B0 { uint tets[]; };
layout(set = 0, binding = 1) readonly buffer B1 { TetShape shapes[]; };
layout(set = 0, binding = 2) readonly buffer B2 { uint corner_begin[]; };
layout(set = 0, binding = 3) readonly buffer B3 { uint corners[]; };
layout(set = 0, binding = 4) readonly buffer B4 { float nodes[]; };
layout(set = 0, binding = 5) writeonly buffer B5 { float rotations[]; };

#include "deformation.glsl"

void main() {
  uint node = gl_GlobalInvocationID.x, frame = gl_GlobalInvocationID.y;
  if (node >= push.node_count) return;
  precise float sum[9] = float[9](0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
  for (uint k = corner_begin[node]; k < corner_begin[node + 1]; ++k) {
    uint tet = corners[k] / 4;
    float f[9];
    deformation_gradient(tet, 3 * push.node_count * frame, f);
    for (int i = 0; i < 9; ++i) sum[i] += shapes[tet].volume * f[i];
  }
  float r[9];
  rot(sum, r);
  uint at = 9 * (frame * push.node_count + node);
  for (int i = 0; i < 9; ++i) rotations[at + i] = r[i];
}
