#version 450
#extension GL_GOOGLE_include_directive : require
// Jiggle stage, begin of a step: the state in the nodes' frames, springs of active muscles, right side of the first
// solve. Semantics: runtime/cpu/dynamics_kernels.h.
#include "jiggle.h"

// Threads: push.node_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { JiggleStepPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { JiggleNode nodes[]; };
layout(set = 0, binding = 1) readonly buffer B1 { float rotations[]; };  // of the batch, as strains and controls
layout(set = 0, binding = 2) readonly buffer B2 { float strains[]; };
layout(set = 0, binding = 3) readonly buffer B3 { float controls[]; };
layout(set = 0, binding = 4) readonly buffer B4 { float motion[]; };
layout(set = 0, binding = 5) writeonly buffer B5 { float local_displacement[]; };
layout(set = 0, binding = 6) writeonly buffer B6 { float local_velocity[]; };
layout(set = 0, binding = 7) writeonly buffer B7 { float right_side[]; };

// How active the muscle of a node is, 0..1.
float activation(JiggleNode node) {
  precise float contracted = 0.0;
  if (node.fibre_count > 0) {
    uint first = push.fibre_count * push.frame + node.first_fibre;
    precise float sum = 0.0;
    for (uint f = 0; f < node.fibre_count; ++f) sum += strains[first + f];
    contracted = clamp(-sum / float(node.fibre_count) / kFullActivationStrain, 0.0, 1.0);
  }
  precise float flexed = 0.0;
  if (node.control < push.control_count) {
    flexed = clamp(controls[push.control_count * push.frame + node.control], 0.0, 1.0);
  }
  precise float all = contracted + (1.0 - contracted) * flexed;
  return all;
}

void main() {
  uint n = gl_GlobalInvocationID.x;
  if (n >= push.node_count) return;
  JiggleNode node = nodes[n];
  float r[9], world_u[3], world_v[3], u[3], v[3], b[3];
  for (uint i = 0; i < 9; ++i) r[i] = rotations[9 * (push.node_count * push.frame + n) + i];
  for (uint i = 0; i < 3; ++i) {
    world_u[i] = motion[3 * (kMotionDisplacement * push.node_count + n) + i];
    world_v[i] = motion[3 * (kMotionVelocity * push.node_count + n) + i];
  }
  turn_back(r, world_u, u);
  turn_back(r, world_v, v);
  precise float pull = push.duration * (node.stiffening * activation(node));
  precise float drag = 1.0 + push.duration * pull;
  for (uint i = 0; i < 3; ++i) {
    precise float kicked = (v[i] - pull * u[i]) / drag;
    v[i] = kicked;
  }
  node_right_side(node, push, r, u, v, b);
  for (uint i = 0; i < 3; ++i) {
    local_displacement[3 * n + i] = u[i];
    local_velocity[3 * n + i] = v[i];
    right_side[3 * n + i] = b[i];
  }
}
