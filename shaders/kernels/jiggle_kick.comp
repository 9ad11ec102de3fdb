#version 450
#extension GL_GOOGLE_include_directive : require
// Jiggle stage, once a frame: where the quasi-static nodes turn, the tissue is kicked. Semantics:
// runtime/cpu/dynamics_kernels.h. Elements are the 3 N numbers.
#include "layout.h"

// Threads: 3 * push.node_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { JiggleKickPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { float nodes[]; };   // of the batch
layout(set = 0, binding = 1) readonly buffer B1 { float before[]; };  // a motion
layout(set = 0, binding = 2) writeonly buffer B2 { float after[]; };

void main() {
  uint k = gl_GlobalInvocationID.x;
  if (k >= 3 * push.node_count) return;
  float origin_step[3] = float[3](push.origin_step_x, push.origin_step_y, push.origin_step_z);
  float x = nodes[3 * push.node_count * push.frame + k];
  uint numbers = 3 * push.node_count;
  precise float u = 0.0, v = 0.0, node_velocity = 0.0;
  if (push.start > 0) {
    u = before[kMotionDisplacement * numbers + k];
    v = before[kMotionVelocity * numbers + k];
    node_velocity = (x - before[kMotionNodes * numbers + k] + origin_step[k % 3]) * push.inverse_interval;
    if (push.start > 1) v -= node_velocity - before[kMotionNodeVelocity * numbers + k];
  }
  after[kMotionDisplacement * numbers + k] = u;
  after[kMotionVelocity * numbers + k] = v;
  after[kMotionNodes * numbers + k] = x;
  after[kMotionNodeVelocity * numbers + k] = node_velocity;
}
