#version 450
#extension GL_GOOGLE_include_directive : require
// Jiggle stage, quality mode: what every tet pulls with. Semantics: runtime/cpu/dynamics_kernels.h.
#include "jiggle.h"

// Threads: push.tet_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { JiggleStressPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { uint tets[]; };
layout(set = 0, binding = 1) readonly buffer B1 { TetShape shapes[]; };
layout(set = 0, binding = 2) readonly buffer B2 { TetElasticity elasticity[]; };
layout(set = 0, binding = 3) readonly buffer B3 { float rotations[]; };  // of the batch
layout(set = 0, binding = 4) readonly buffer B4 { float tet_rotations[]; };
layout(set = 0, binding = 5) readonly buffer B5 { float direction[]; };
layout(set = 0, binding = 6) writeonly buffer B6 { float tractions[]; };

// R_i direction_i.
void world_direction(uint node, out float p[3]) {
  float r[9], d[3];
  for (uint i = 0; i < 9; ++i) r[i] = rotations[9 * (push.node_count * push.frame + node) + i];
  for (uint i = 0; i < 3; ++i) d[i] = direction[3 * node + i];
  turn(r, d, p);
}

void main() {
  uint tet = gl_GlobalInvocationID.x;
  if (tet >= push.tet_count) return;
  float r[9], origin[3], corner[3];
  for (uint i = 0; i < 9; ++i) r[i] = tet_rotations[9 * tet + i];
  world_direction(tets[4 * tet], origin);
  precise float edges[9];  // R_e^T times the edges of p
  for (uint j = 0; j < 3; ++j) {
    world_direction(tets[4 * tet + 1 + j], corner);
    float edge[3], local[3];
    for (uint i = 0; i < 3; ++i) {
      precise float difference = corner[i] - origin[i];
      edge[i] = difference;
    }
    turn_back(r, edge, local);
    for (uint i = 0; i < 3; ++i) edges[3 * i + j] = local[i];
  }
  TetShape shape = shapes[tet];
  precise float gradient[9];
  for (uint i = 0; i < 3; ++i) {
    for (uint k = 0; k < 3; ++k) {
      gradient[3 * i + k] = edges[3 * i] * shape.inverse_edges[k] + edges[3 * i + 1] * shape.inverse_edges[3 + k] +
                            edges[3 * i + 2] * shape.inverse_edges[6 + k];
    }
  }
  precise float pressure = elasticity[tet].lambda * (gradient[0] + gradient[4] + gradient[8]);
  for (uint k = 0; k < 3; ++k) {  // column k of sigma
    float column[3], pull[3];
    for (uint i = 0; i < 3; ++i) {
      precise float value = elasticity[tet].mu * (gradient[3 * i + k] + gradient[3 * k + i]);
      if (i == k) value += pressure;
      column[i] = value;
    }
    turn(r, column, pull);
    for (uint i = 0; i < 3; ++i) tractions[9 * tet + 3 * i + k] = shape.volume * pull[i];
  }
}
