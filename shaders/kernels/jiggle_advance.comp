#version 450
#extension GL_GOOGLE_include_directive : require
// Jiggle stage, between the two solves of TR-BDF2. Semantics: runtime/cpu/dynamics_kernels.h.
#include "jiggle.h"

// Threads: push.node_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { JiggleStepPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { JiggleNode nodes[]; };
layout(set = 0, binding = 1) readonly buffer B1 { float rotations[]; };  // of the batch
layout(set = 0, binding = 2) readonly buffer B2 { float solution[]; };
layout(set = 0, binding = 3) readonly buffer B3 { float local_displacement[]; };
layout(set = 0, binding = 4) readonly buffer B4 { float local_velocity[]; };
layout(set = 0, binding = 5) writeonly buffer B5 { float next_displacement[]; };
layout(set = 0, binding = 6) writeonly buffer B6 { float next_velocity[]; };
layout(set = 0, binding = 7) writeonly buffer B7 { float right_side[]; };

void main() {
  uint n = gl_GlobalInvocationID.x;
  if (n >= push.node_count) return;
  float r[9], u[3], v[3], b[3];
  for (uint i = 0; i < 9; ++i) r[i] = rotations[9 * (push.node_count * push.frame + n) + i];
  for (uint i = 0; i < 3; ++i) {
    uint k = 3 * n + i;
    precise float next_u = push.u_from_u * local_displacement[k] + push.u_from_z * solution[k];
    precise float next_v =
        push.v_from_u * local_displacement[k] + push.v_from_z * solution[k] + push.v_from_v * local_velocity[k];
    u[i] = next_u;
    v[i] = next_v;
  }
  node_right_side(nodes[n], push, r, u, v, b);
  for (uint i = 0; i < 3; ++i) {
    next_displacement[3 * n + i] = u[i];
    next_velocity[3 * n + i] = v[i];
    right_side[3 * n + i] = b[i];
  }
}
