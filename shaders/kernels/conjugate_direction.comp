#version 450
#extension GL_GOOGLE_include_directive : require
// Quality mode: the next direction of conjugate gradients. Semantics: runtime/cpu/dynamics_kernels.h.
#include "conjugate.h"
#include "layout.h"

// Threads: push.count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { ConjugatePush push; };
layout(set = 0, binding = 0) readonly buffer B0 { float rho[]; };
layout(set = 0, binding = 1) readonly buffer B1 { float next_rho[]; };
layout(set = 0, binding = 2) readonly buffer B2 { float y[]; };
layout(set = 0, binding = 3) readonly buffer B3 { float direction[]; };
// May be the buffer of binding 3: a lane reads the number that it writes, no other.
layout(set = 0, binding = 4) writeonly buffer B4 { float next_direction[]; };

void main() {
  uint k = gl_GlobalInvocationID.x;
  if (k >= push.count) return;
  precise float beta = conjugate_ratio(next_rho[0], rho[0]);
  precise float p = y[k] + beta * direction[k];
  next_direction[k] = p;
}
