#version 450
#extension GL_GOOGLE_include_directive : require
// Jiggle stage, end of a step: the state in world axes. Semantics: runtime/cpu/dynamics_kernels.h.
#include "jiggle.h"

// Threads: push.node_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { JiggleStepPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { float rotations[]; };  // of the batch
layout(set = 0, binding = 1) readonly buffer B1 { float solution[]; };
layout(set = 0, binding = 2) readonly buffer B2 { float local_displacement[]; };
layout(set = 0, binding = 3) writeonly buffer B3 { float motion[]; };

void main() {
  uint n = gl_GlobalInvocationID.x;
  if (n >= push.node_count) return;
  float r[9], u[3], v[3], world_u[3], world_v[3];
  for (uint i = 0; i < 9; ++i) r[i] = rotations[9 * (push.node_count * push.frame + n) + i];
  for (uint i = 0; i < 3; ++i) {
    uint k = 3 * n + i;
    precise float last_u = push.u_from_u * local_displacement[k] + push.u_from_z * solution[k];
    precise float last_v = push.v_from_u * local_displacement[k] + push.v_from_z * solution[k];
    u[i] = last_u;
    v[i] = last_v;
  }
  turn(r, u, world_u);
  turn(r, v, world_v);
  for (uint i = 0; i < 3; ++i) {
    motion[3 * (kMotionDisplacement * push.node_count + n) + i] = abs(world_u[i]) < kStill ? 0.0 : world_u[i];
    motion[3 * (kMotionVelocity * push.node_count + n) + i] = abs(world_v[i]) < kStill ? 0.0 : world_v[i];
  }
}
