#version 450
#extension GL_GOOGLE_include_directive : require
// Quality mode: a step of conjugate gradients. Semantics: runtime/cpu/dynamics_kernels.h.
#include "conjugate.h"
#include "layout.h"

// Threads: push.count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { ConjugatePush push; };
layout(set = 0, binding = 0) readonly buffer B0 { float rho[]; };
layout(set = 0, binding = 1) readonly buffer B1 { float pq[]; };
layout(set = 0, binding = 2) readonly buffer B2 { float direction[]; };
layout(set = 0, binding = 3) readonly buffer B3 { float product[]; };
layout(set = 0, binding = 4) readonly buffer B4 { float solution[]; };
layout(set = 0, binding = 5) readonly buffer B5 { float residual[]; };
// May be the buffers of the bindings above: a lane reads the numbers that it writes, no others.
layout(set = 0, binding = 6) writeonly buffer B6 { float next_solution[]; };
layout(set = 0, binding = 7) writeonly buffer B7 { float next_residual[]; };

void main() {
  uint k = gl_GlobalInvocationID.x;
  if (k >= push.count) return;
  precise float alpha = conjugate_ratio(rho[0], pq[0]);
  precise float x = solution[k] + alpha * direction[k];
  precise float r = residual[k] - alpha * product[k];
  next_solution[k] = x;
  next_residual[k] = r;
}
