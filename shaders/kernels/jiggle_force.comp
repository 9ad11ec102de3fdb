#version 450
#extension GL_GOOGLE_include_directive : require
// Jiggle stage, quality mode: product with the corotated operator. Semantics: runtime/cpu/dynamics_kernels.h.
#include "jiggle.h"

// Threads: push.node_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { JiggleForcePush push; };
layout(set = 0, binding = 0) readonly buffer B0 { TetShape shapes[]; };
layout(set = 0, binding = 1) readonly buffer B1 { uint corner_begin[]; };
layout(set = 0, binding = 2) readonly buffer B2 { uint corners[]; };
layout(set = 0, binding = 3) readonly buffer B3 { uint held_begin[]; };
layout(set = 0, binding = 4) readonly buffer B4 { uint held_columns[]; };
layout(set = 0, binding = 5) readonly buffer B5 { float held_values[]; };
layout(set = 0, binding = 6) readonly buffer B6 { float rotations[]; };  // of the batch
layout(set = 0, binding = 7) readonly buffer B7 { float tractions[]; };
layout(set = 0, binding = 8) readonly buffer B8 { float direction[]; };
layout(set = 0, binding = 9) writeonly buffer B9 { float product[]; };

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
  for (uint k = held_begin[node]; k < held_begin[node + 1]; ++k) {
    uint other = held_columns[k];
    float d[3], p[3];
    load_rotation(other, r);
    for (uint i = 0; i < 3; ++i) d[i] = direction[3 * other + i];
    turn(r, d, p);
    for (uint i = 0; i < 3; ++i) sum[i] += held_values[k] * p[i];
  }
  for (uint k = corner_begin[node]; k < corner_begin[node + 1]; ++k) {
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
