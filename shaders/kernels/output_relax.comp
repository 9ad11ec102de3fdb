#version 450
#extension GL_GOOGLE_include_directive : require
// Output stage: a step in which skin that is compressed is evened out. Semantics: runtime/cpu/kernels.h.
#include "layout.h"
#include "relax.h"

// Threads: push.end_vertex - push.first_vertex
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { OutputRelaxPush push; };
layout(set = 0, binding = 0) readonly buffer B0 { uint fan_begin[]; };
layout(set = 0, binding = 1) readonly buffer B1 { uint fans[]; };  // three corners of each triangle around a vertex
layout(set = 0, binding = 2) readonly buffer B2 { float rest[]; };
layout(set = 0, binding = 3) readonly buffer B3 { float weights[]; };
layout(set = 0, binding = 4) readonly buffer B4 { float current[]; };
layout(set = 0, binding = 5) writeonly buffer B5 { float relaxed[]; };

void main() {
  uint vertex = push.first_vertex + gl_GlobalInvocationID.x, frame = gl_GlobalInvocationID.y;
  if (vertex >= push.end_vertex || vertex >= push.vertex_count) return;
  uint x = 3 * push.vertex_count * frame, at = x + 3 * vertex;
  float shown = min(max(weights[push.component_count * frame + push.component], 0.0), 1.0);
  float own[3], sums[9];
  for (uint i = 0; i < 3; ++i) own[i] = current[at + i];
  for (uint i = 0; i < 9; ++i) sums[i] = 0.0;
  uint begin = 3 * (fan_begin[vertex] - push.first_triangle);
  uint end = shown > 0.0 ? 3 * (fan_begin[vertex + 1] - push.first_triangle) : begin;
  for (uint t = begin; t < end; t += 3) {
    uint corner = fans[t] == vertex ? 0 : fans[t + 1] == vertex ? 1 : 2;
    uint next = fans[t + (corner + 1) % 3], last = fans[t + (corner + 2) % 3];
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
