#version 450
#extension GL_GOOGLE_include_directive : require
// Output stage: a step in which skin is taken out of skin. Semantics: runtime/cpu/kernels.h.
#include "fold.h"

// Threads: push.vertex_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { OutputSeparatePush push; };
layout(set = 0, binding = 0) readonly buffer B0 { FoldVertex fold_vertices[]; };
layout(set = 0, binding = 1) readonly buffer B1 { FoldList fold_lists[]; };
layout(set = 0, binding = 2) readonly buffer B2 { uint fold_triangles[]; };
layout(set = 0, binding = 3) readonly buffer B3 { uint triangles[]; };
layout(set = 0, binding = 4) readonly buffer B4 { float weights[]; };
layout(set = 0, binding = 5) readonly buffer B5 { float posed[]; };
layout(set = 0, binding = 6) readonly buffer B6 { float current[]; };
layout(set = 0, binding = 7) writeonly buffer B7 { float separated[]; };

void main() {
  uint vertex = gl_GlobalInvocationID.x, frame = gl_GlobalInvocationID.y;
  if (vertex >= push.vertex_count) return;
  uint x = 3 * push.vertex_count * frame, at = x + 3 * vertex;
  float own[3], from[3], pull[4], shown = 0.0, reach = 0.0;
  for (uint i = 0; i < 3; ++i) {
    own[i] = current[at + i];
    from[i] = posed[at + i];
  }
  for (uint i = 0; i < 4; ++i) pull[i] = 0.0;
  FoldVertex fold = fold_vertices[vertex];
  float last[3], next[3], normal[3];
  for (uint i = 0; i < 3; ++i) {
    last[i] = current[x + 3 * fold.ring[kFoldRing - 1] + i] - own[i];
    normal[i] = 0.0;
  }
  for (uint r = 0; r < kFoldRing; ++r) {
    for (uint i = 0; i < 3; ++i) next[i] = current[x + 3 * fold.ring[r] + i] - own[i];
    add_fold_cross(last, next, normal);
    last = next;
  }
  for (uint l = fold.first_list; l < fold_vertices[vertex + 1].first_list; ++l) {
    float weight = weights[push.component_count * frame + fold_lists[l].component];
    if (!(weight > 0.0)) continue;
    shown = max(shown, min(weight, 1.0));
    reach = max(reach, fold_lists[l].reach);
    for (uint k = fold_lists[l].first; k < fold_lists[l + 1].first; ++k) {
      float corners[3][3];
      for (uint c = 0; c < 3; ++c) {
        uint corner = x + 3 * triangles[3 * fold_triangles[k] + c];
        for (uint i = 0; i < 3; ++i) corners[c][i] = current[corner + i] - own[i];
      }
      add_fold_pull(normal, corners[0], corners[1], corners[2], fold_lists[l].reach, pull);
    }
  }
  float moved[3];
  fold_step(pull, from, own, reach, push.last == 1 ? shown : -1.0, moved);
  for (uint i = 0; i < 3; ++i) separated[at + i] = moved[i];
}
