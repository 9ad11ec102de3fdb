#version 450
#extension GL_GOOGLE_include_directive : require
// Output stage: a step in which skin that has crossed skin in a fold is taken out of it. Semantics:
// runtime/cpu/kernels.h.
#include "fold.h"
#include "layout.h"

// Threads: push.vertex_count
layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Constants { OutputSeparatePush push; };
layout(set = 0, binding = 0) readonly buffer B0 { uint triangles[]; };
layout(set = 0, binding = 1) readonly buffer B1 { uint sides[]; };
layout(set = 0, binding = 2) readonly buffer B2 { float boxes[]; };
layout(set = 0, binding = 3) readonly buffer B3 { float weights[]; };
layout(set = 0, binding = 4) readonly buffer B4 { float normals[]; };
layout(set = 0, binding = 5) readonly buffer B5 { float posed[]; };
layout(set = 0, binding = 6) readonly buffer B6 { float current[]; };
layout(set = 0, binding = 7) writeonly buffer B7 { float moved[]; };

uint words() { return (push.fold_count + 31) / 32; }
bool is_child(uint vertex, uint fold) {
  return (sides[2 * words() * vertex + words() + fold / 32] >> fold % 32 & 1u) == 1u;
}

// Adds the triangles of a box.
void add_box(uint box, uint x, float point[3], float n[3], float u[3], float w[3], uint fold, bool child,
             inout float found[6]) {
  uint end = min(kBoxTriangles * (box + 1), push.triangle_count);
  for (uint t = kBoxTriangles * box; t < end; ++t) {
    float corners[3][3];
    bool other = false;
    for (uint k = 0; k < 3; ++k) {
      uint vertex = triangles[3 * t + k];
      other = other || is_child(vertex, fold) != child;
      for (uint i = 0; i < 3; ++i) corners[k][i] = current[x + 3 * vertex + i] - point[i];
    }
    add_fold_triangle(corners[0], corners[1], corners[2], n, u, w, other, found);
  }
}

void main() {
  uint vertex = gl_GlobalInvocationID.x, frame = gl_GlobalInvocationID.y;
  if (vertex >= push.vertex_count) return;
  uint x = 3 * push.vertex_count * frame, at = x + 3 * vertex;
  float own[3], before[3], normal[3], point[3], way[3];
  bool stands = true;
  for (uint i = 0; i < 3; ++i) {
    own[i] = current[at + i];
    before[i] = posed[at + i];
    normal[i] = normals[at + i];
    precise float outside = own[i] + kFoldOffset * normal[i];
    point[i] = outside;
    stands = stands && own[i] == before[i];
    moved[at + i] = own[i];
  }
  if (push.step > 0 && stands) return;
  float least = 3.4e38;
  for (uint fold = 0; fold < push.fold_count; ++fold) {
    if ((sides[2 * words() * vertex + fold / 32] >> fold % 32 & 1u) == 0u) continue;
    float n[3], u[3], w[3];
    uint weight = push.component_count * frame + push.component + 3 * fold;
    for (uint i = 0; i < 3; ++i) n[i] = weights[weight + i];
    bool child = is_child(vertex, fold);
    float facing = dot_product(normal, n), squared = dot_product(n, n);
    if (!(squared > 0.0) || !(child ? facing < 0.0 : facing > 0.0)) continue;
    fold_axes(n, u, w);
    float found[6] = float[6](0.0, 0.0, 0.0, 0.0, 3.4e38, -3.4e38);
    for (uint box = 0; box < push.box_count; ++box) {
      float middle[3], half_edge[3];
      uint b = 6 * (push.box_count * frame + box);
      for (uint i = 0; i < 3; ++i) {
        middle[i] = 0.5 * (boxes[b + i] + boxes[b + 3 + i]) - point[i];
        half_edge[i] = 0.5 * (boxes[b + 3 + i] - boxes[b + i]);
      }
      if (fold_passes_by(middle, half_edge, u) || fold_passes_by(middle, half_edge, w)) continue;
      add_box(box, x, point, n, u, w, fold, child, found);
    }
    float depth = fold_depth(found, child, kFoldOffset * facing), size = sqrt(squared);
    if (!(depth > 0.0) || !(depth / size < least)) continue;
    least = depth / size;
    float share = (child ? 0.5 : -0.5) * min(size, 1.0) * depth / squared;
    for (uint i = 0; i < 3; ++i) way[i] = share * n[i];
  }
  if (least == 3.4e38) return;
  float to[3];
  fold_step(way, before, own, push.limit, to);
  for (uint i = 0; i < 3; ++i) moved[at + i] = to[i];
}
