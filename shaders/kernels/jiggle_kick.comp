#version 450
#extension GL_GOOGLE_include_directive : require
// Jiggle stage, once a frame: where the quasi-static nodes turn, the tissue is kicked. Semantics:
// runtime/cpu/dynamics_kernels.h. Elements are the 3 N numbers.
#include "layout.h"

// Threads: 3 * push.node_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { JiggleKickPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { float nodes[]; };  // of the batch
layout(set = 0, binding = 1) readonly buffer B1 { float displacement_before[]; };
layout(set = 0, binding = 2) readonly buffer B2 { float velocity_before[]; };
layout(set = 0, binding = 3) readonly buffer B3 { float nodes_before[]; };
layout(set = 0, binding = 4) readonly buffer B4 { float node_velocity_before[]; };
layout(set = 0, binding = 5) writeonly buffer B5 { float displacement_after[]; };
layout(set = 0, binding = 6) writeonly buffer B6 { float velocity_after[]; };
layout(set = 0, binding = 7) writeonly buffer B7 { float nodes_after[]; };
layout(set = 0, binding = 8) writeonly buffer B8 { float node_velocity_after[]; };

void main() {
  uint k = gl_GlobalInvocationID.x;
  if (k >= 3 * push.node_count) return;
  float origin_step[3] = float[3](push.origin_step_x, push.origin_step_y, push.origin_step_z);
  float x = nodes[3 * push.node_count * push.frame + k];
  precise float u = 0.0, v = 0.0, node_velocity = 0.0;
  if (push.start > 0) {
    u = displacement_before[k];
    v = velocity_before[k];
    node_velocity = (x - nodes_before[k] + origin_step[k % 3]) * push.inverse_interval;
    if (push.start > 1) v -= node_velocity - node_velocity_before[k];
  }
  displacement_after[k] = u;
  velocity_after[k] = v;
  nodes_after[k] = x;
  node_velocity_after[k] = node_velocity;
}
