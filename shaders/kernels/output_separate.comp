#version 450
#extension GL_GOOGLE_include_directive : require
// Output stage: a step in which skin is taken out of skin. Semantics: runtime/cpu/kernels.h.
#include "fold.h"

// Threads: push.vertex_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { OutputSeparatePush push; };
layout(set = 0, binding = 0) readonly buffer B0 { uint fold_begin[]; };
layout(set = 0, binding = 1) readonly buffer B1 { uint fold_triangles[]; };
layout(set = 0, binding = 2) readonly buffer B2 { uint triangles[]; };
layout(set = 0, binding = 3) readonly buffer B3 { float weights[]; };
layout(set = 0, binding = 4) readonly buffer B4 { float posed[]; };
layout(set = 0, binding = 5) readonly buffer B5 { float current[]; };
layout(set = 0, binding = 6) writeonly buffer B6 { float separated[]; };

void main() {
  uint vertex = gl_GlobalInvocationID.x, frame = gl_GlobalInvocationID.y;
  if (vertex >= push.vertex_count) return;
  uint x = 3 * push.vertex_count * frame, at = x + 3 * vertex;
  float weight = min(max(weights[push.component_count * frame + push.component], 0.0), 1.0);
  float own[3], from[3], pull[4];
  for (uint i = 0; i < 3; ++i) {
    own[i] = current[at + i];
    from[i] = posed[at + i];
  }
  for (uint i = 0; i < 4; ++i) pull[i] = 0.0;
  uint begin = fold_begin[vertex], end = weight > 0.0 ? fold_begin[vertex + 1] : begin;
  for (uint k = begin; k < end; ++k) {
    float corners[3][3];
    for (uint c = 0; c < 3; ++c) {
      uint corner = x + 3 * triangles[3 * fold_triangles[k] + c];
      for (uint i = 0; i < 3; ++i) corners[c][i] = current[corner + i] - own[i];
    }
    add_fold_pull(corners[0], corners[1], corners[2], push.reach, pull);
  }
  float moved[3];
  fold_step(pull, from, own, push.reach, push.last == 1 ? weight : -1.0, moved);
  for (uint i = 0; i < 3; ++i) separated[at + i] = moved[i];
}
