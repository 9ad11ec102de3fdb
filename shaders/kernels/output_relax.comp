#version 450
#extension GL_GOOGLE_include_directive : require
// Output stage: a step in which skin that is compressed is evened out. Semantics: runtime/cpu/kernels.h.
#include "layout.h"
#include "relax.h"

// Threads: push.vertex_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { OutputRelaxPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { uint triangles[]; };
layout(set = 0, binding = 1) readonly buffer B1 { uint vertex_triangle_begin[]; };
layout(set = 0, binding = 2) readonly buffer B2 { uint vertex_triangles[]; };
layout(set = 0, binding = 3) readonly buffer B3 { float rest[]; };
layout(set = 0, binding = 4) readonly buffer B4 { float weights[]; };
layout(set = 0, binding = 5) readonly buffer B5 { float current[]; };
layout(set = 0, binding = 6) writeonly buffer B6 { float relaxed[]; };

void main() {
  uint vertex = gl_GlobalInvocationID.x, frame = gl_GlobalInvocationID.y;
  if (vertex >= push.vertex_count) return;
  uint x = 3 * push.vertex_count * frame, at = x + 3 * vertex;
  float shown = min(max(weights[push.component_count * frame + push.component], 0.0), 1.0);
  float own[3], sums[9];
  for (uint i = 0; i < 3; ++i) own[i] = current[at + i];
  for (uint i = 0; i < 9; ++i) sums[i] = 0.0;
  uint begin = vertex_triangle_begin[vertex], end = shown > 0.0 ? vertex_triangle_begin[vertex + 1] : begin;
  for (uint k = begin; k < end; ++k) {
    uint t = 3 * vertex_triangles[k];
    uint corner = triangles[t] == vertex ? 0 : triangles[t + 1] == vertex ? 1 : 2;
    uint next = triangles[t + (corner + 1) % 3], last = triangles[t + (corner + 2) % 3];
    float p[3], q[3], rest_p[3], rest_q[3];
    for (uint i = 0; i < 3; ++i) {
      p[i] = current[x + 3 * next + i] - own[i];
      q[i] = current[x + 3 * last + i] - own[i];
      rest_p[i] = rest[3 * next + i] - rest[3 * vertex + i];
      rest_q[i] = rest[3 * last + i] - rest[3 * vertex + i];
    }
    add_relax_corner(p, q, rest_p, rest_q, sums);
  }
  float moved[3];
  relax_step(sums, own, shown, moved);
  for (uint i = 0; i < 3; ++i) relaxed[at + i] = moved[i];
}
