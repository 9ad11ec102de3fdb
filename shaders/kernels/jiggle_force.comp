#version 450
#extension GL_GOOGLE_include_directive : require
// Jiggle stage, quality mode: product with the corotated operator. Semantics: runtime/cpu/dynamics_kernels.h.
#include "jiggle.h"

// Threads: push.node_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { JiggleForcePush push; };
layout(set = 0, binding = 0) readonly buffer B0 { TetShape shapes[]; };
layout(set = 0, binding = 1) readonly buffer B1 { NodeRows rows[]; };
layout(set = 0, binding = 2) readonly buffer B2 { uint corners[]; };
layout(set = 0, binding = 3) readonly buffer B3 { HeldNode held[]; };
layout(set = 0, binding = 4) readonly buffer B4 { float rotations[]; };  // of the batch
layout(set = 0, binding = 5) readonly buffer B5 { float tractions[]; };
layout(set = 0, binding = 6) readonly buffer B6 { float direction[]; };
layout(set = 0, binding = 7) writeonly buffer B7 { float product[]; };

void load_rotation(uint node, out float r[9]) {
  for (uint i = 0; i < 9; ++i) r[i] = rotations[9 * (push.node_count * push.frame + node) + i];
}

// Gradient of the shape function of a corner (4 x tet + corner) of a tet at rest.
void corner_gradient(uint corner, out float gradient[3]) {
  uint tet = corner / 4, c = corner % 4;
  for (uint k = 0; k < 3; ++k) {
    precise float value;
    if (c == 0) {
      value = -(shapes[tet].inverse_edges[k] + shapes[tet].inverse_edges[3 + k] + shapes[tet].inverse_edges[6 + k]);
    } else {
      value = shapes[tet].inverse_edges[3 * (c - 1) + k];
    }
    gradient[k] = value;
  }
}

void main() {
  uint node = gl_GlobalInvocationID.x;
  if (node >= push.node_count) return;
  precise float sum[3] = float[3](0.0, 0.0, 0.0);
  float r[9];
  for (uint k = rows[node].held_begin; k < rows[node + 1].held_begin; ++k) {
    uint other = held[k].column;
    float d[3], p[3];
    load_rotation(other, r);
    for (uint i = 0; i < 3; ++i) d[i] = direction[3 * other + i];
    turn(r, d, p);
    for (uint i = 0; i < 3; ++i) sum[i] += held[k].value * p[i];
  }
  for (uint k = rows[node].corner_begin; k < rows[node + 1].corner_begin; ++k) {
    uint traction = 9 * (corners[k] / 4);
    float gradient[3];
    corner_gradient(corners[k], gradient);
    for (uint i = 0; i < 3; ++i) {
      sum[i] += tractions[traction + 3 * i] * gradient[0] + tractions[traction + 3 * i + 1] * gradient[1] +
                tractions[traction + 3 * i + 2] * gradient[2];
    }
  }
  float force[3], local[3];
  for (uint i = 0; i < 3; ++i) force[i] = sum[i];
  load_rotation(node, r);
  turn_back(r, force, local);
  for (uint i = 0; i < 3; ++i) product[3 * node + i] = local[i];
}
