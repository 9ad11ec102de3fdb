#version 450
#extension GL_GOOGLE_include_directive : require
// Jiggle stage: the skin goes along with its tets. Semantics: runtime/cpu/dynamics_kernels.h.
#include "jiggle.h"

// Threads: push.vertex_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { JiggleSkinPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { uint tets[]; };
layout(set = 0, binding = 1) readonly buffer B1 { TetPoint skin[]; };
layout(set = 0, binding = 2) readonly buffer B2 { float limit[]; };
layout(set = 0, binding = 3) readonly buffer B3 { float positions[]; };
layout(set = 0, binding = 4) readonly buffer B4 { float displacement[]; };
layout(set = 0, binding = 5) writeonly buffer B5 { float moved[]; };

void main() {
  uint vertex = gl_GlobalInvocationID.x;
  if (vertex >= push.vertex_count) return;
  uint at = 3 * (push.frame * push.vertex_count + vertex);
  TetPoint point = skin[vertex];
  precise float amount = push.weight * point.amount;
  if (amount == 0.0) {
    for (uint i = 0; i < 3; ++i) moved[at + i] = positions[at + i];
    return;
  }
  uint tet = 4 * point.tet;
  uint a = 3 * tets[tet], b = 3 * tets[tet + 1], c = 3 * tets[tet + 2], d = 3 * tets[tet + 3];
  float u[3];
  for (uint i = 0; i < 3; ++i) {
    precise float of_tet = point.w0 * displacement[a + i] + point.w1 * displacement[b + i] +
                           point.w2 * displacement[c + i] + point.w3 * displacement[d + i];
    u[i] = of_tet;
  }
  precise float squared = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
  precise float taken = amount * limited_share(squared, limit[vertex]);
  for (uint i = 0; i < 3; ++i) {
    precise float x = positions[at + i] + taken * u[i];
    moved[at + i] = x;
  }
}
