#version 450
#extension GL_GOOGLE_include_directive : require
// Output stage: normals by the sum of area vectors of the triangles around each vertex. Semantics:
// runtime/cpu/kernels.h.
#include "layout.h"

// Threads: push.end_vertex - push.first_vertex
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { OutputNormalsPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { uint fan_begin[]; };
layout(set = 0, binding = 1) readonly buffer B1 { uint fans[]; };  // three corners of each triangle around a vertex
layout(set = 0, binding = 2) readonly buffer B2 { float positions[]; };
layout(set = 0, binding = 3) writeonly buffer B3 { float normals[]; };

void main() {
  uint vertex = push.first_vertex + gl_GlobalInvocationID.x, frame = gl_GlobalInvocationID.y;
  if (vertex >= push.end_vertex || vertex >= push.vertex_count) return;
  uint x = 3 * push.vertex_count * frame;
  precise float nx = 0.0, ny = 0.0, nz = 0.0;
  uint end = 3 * (fan_begin[vertex + 1] - push.first_triangle);
  for (uint t = 3 * (fan_begin[vertex] - push.first_triangle); t < end; t += 3) {
    uint a = x + 3 * fans[t], b = x + 3 * fans[t + 1], c = x + 3 * fans[t + 2];
    precise float ux = positions[b] - positions[a], uy = positions[b + 1] - positions[a + 1],
                  uz = positions[b + 2] - positions[a + 2];
    precise float wx = positions[c] - positions[a], wy = positions[c + 1] - positions[a + 1],
                  wz = positions[c + 2] - positions[a + 2];
    nx += uy * wz - uz * wy;
    ny += uz * wx - ux * wz;
    nz += ux * wy - uy * wx;
  }
  precise float length2 = nx * nx + ny * ny + nz * nz;
  float length = sqrt(length2);
  float scale = length > 1e-20 ? 1.0 / length : 0.0;
  uint at = x + 3 * vertex;
  normals[at] = nx * scale;
  normals[at + 1] = ny * scale;
  normals[at + 2] = nz * scale;
}
