#version 450
#extension GL_GOOGLE_include_directive : require
// Jiggle stage, quality mode: rotation of every tet. Semantics: runtime/cpu/dynamics_kernels.h.
#include "layout.h"
#include "rotation.h"

// Threads: push.tet_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { JiggleTetRotatePush push; };
layout(set = 0, binding = 0) readonly buffer B0 { uint tets[]; };
layout(set = 0, binding = 1) readonly buffer B1 { TetShape shapes[]; };
layout(set = 0, binding = 2) readonly buffer B2 { float nodes[]; };  // of the batch
layout(set = 0, binding = 3) writeonly buffer B3 { float tet_rotations[]; };

#include "deformation.glsl"

void main() {
  uint tet = gl_GlobalInvocationID.x;
  if (tet >= push.tet_count) return;
  float f[9], r[9];
  deformation_gradient(tet, 3 * push.node_count * push.frame, f);
  rot(f, r);
  for (uint i = 0; i < 9; ++i) tet_rotations[9 * tet + i] = r[i];
}
