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

// The workgroup's vertices that may lie in a fold, along its axes u, w and n: where each is, then all of them at 0.
shared float from[3][kWorkgroupSize], to[3][kWorkgroupSize];
shared uint member_count;
// Is there skin of the other side above and below any of them, as the parent's side sees it, and, shifted, the child's?
const uint kAbove = 1, kBelow = 2, kBetween = kAbove | kBelow, kChildShift = 2;
shared uint seen;
// Boxes of triangles, of kWorkgroupSize large ones, that lines along n through members may meet.
shared uint met[kWorkgroupSize * kLargeBox], met_count;

uint words() { return (push.fold_count + 31) / 32; }
// entry: a vertex, or push.vertex_count and a box.
bool has_bit(uint entry, uint list, uint fold) {
  return (sides[(2 * entry + list) * words() + fold / 32] >> fold % 32 & 1u) == 1u;
}
bool is_near(uint vertex, uint fold) { return has_bit(vertex, 0, fold); }
bool is_child(uint vertex, uint fold) { return has_bit(vertex, 1, fold); }

void find_spans(float middle[3], float half_edge[3], float axes[3][3], out float spans[3][2]) {
  for (uint k = 0; k < 3; ++k) fold_span(middle, half_edge, axes[k], spans[k]);
}

// Returns how many vertices there are to look at; where they lie is in from and to.
uint gather_members(bool is_member, float spans[3][2]) {
  uint lane = gl_LocalInvocationID.x;
  barrier();
  if (lane == 0) {
    member_count = 0;
    seen = 0;
  }
  barrier();
  for (uint k = 0; k < 3; ++k) {
    from[k][lane] = is_member ? spans[k][0] : 3.4e38;
    to[k][lane] = is_member ? spans[k][1] : -3.4e38;
  }
  if (is_member) atomicAdd(member_count, 1);
  barrier();
  if (member_count == 0) return 0;
  if (lane < 3) {
    for (uint k = 1; k < kWorkgroupSize; ++k) {
      from[lane][0] = min(from[lane][0], from[lane][k]);
      to[lane][0] = max(to[lane][0], to[lane][k]);
    }
  }
  barrier();
  return member_count;
}

void find_box_spans(uint box, float axes[3][3], out float spans[3][2]) {
  float middle[3], half_edge[3];
  uint b = 6 * (push.box_count * gl_GlobalInvocationID.y + box);
  for (uint i = 0; i < 3; ++i) {
    middle[i] = 0.5 * (boxes[b + i] + boxes[b + 3 + i]);
    half_edge[i] = 0.5 * (boxes[b + 3 + i] - boxes[b + i]);
  }
  find_spans(middle, half_edge, axes, spans);
}

bool meet(float a[3][2], float b[3][2]) {
  return a[0][0] <= b[0][1] && a[0][1] >= b[0][0] && a[1][0] <= b[1][1] && a[1][1] >= b[1][0];
}

// The span of all members.
void find_all(out float all[3][2]) {
  for (uint k = 0; k < 3; ++k) {
    all[k][0] = from[k][0];
    all[k][1] = to[k][0];
  }
}

// The boxes of a large one, first .. end; none if no line through a member may meet it.
uint boxes_end(uint large, float axes[3][3], float all[3][2]) {
  float spans[3][2];
  uint small = small_box_count(push.triangle_count);
  if (small + large >= push.box_count) return 0;
  find_box_spans(small + large, axes, spans);
  return meet(spans, all) ? min(kLargeBox * (large + 1), small) : 0;
}

uint find_seen(uint fold, float axes[3][3]) {
  uint found = 0;
  float all[3][2], spans[3][2];
  find_all(all);
  for (uint large = gl_LocalInvocationID.x; large < large_box_count(push.triangle_count); large += kWorkgroupSize) {
    uint end = boxes_end(large, axes, all);
    for (uint box = kLargeBox * large; box < end; ++box) {
      find_box_spans(box, axes, spans);
      if (!meet(spans, all)) continue;
      uint there = (spans[2][1] >= all[2][0] ? kAbove : 0) | (spans[2][0] <= all[2][1] ? kBelow : 0);
      if (has_bit(push.vertex_count + box, 0, fold)) found |= there << kChildShift;
      if (has_bit(push.vertex_count + box, 1, fold)) found |= there;
    }
  }
  if (found != 0) atomicOr(seen, found);
  barrier();
  return seen;
}

void gather_boxes(uint first, float axes[3][3]) {
  barrier();
  if (gl_LocalInvocationID.x == 0) met_count = 0;
  barrier();
  float all[3][2], spans[3][2];
  find_all(all);
  uint large = first + gl_LocalInvocationID.x, end = boxes_end(large, axes, all);
  for (uint box = kLargeBox * large; box < end; ++box) {
    find_box_spans(box, axes, spans);
    if (meet(spans, all)) met[atomicAdd(met_count, 1)] = box;
  }
  barrier();
}

// Adds the triangles of a box.
void add_box(uint box, float point[3], float axes[3][3], uint fold, bool child, inout float found[8]) {
  uint x = 3 * push.vertex_count * gl_GlobalInvocationID.y;
  uint end = min(kBoxTriangles * (box + 1), push.triangle_count);
  for (uint t = kBoxTriangles * box; t < end; ++t) {
    uint vertices[3];
    float corners[3][3];
    for (uint k = 0; k < 3; ++k) {
      vertices[k] = triangles[3 * t + k];
      for (uint i = 0; i < 3; ++i) corners[k][i] = current[x + 3 * vertices[k] + i] - point[i];
    }
    if (is_beside_fold_line(corners[0], corners[1], corners[2], axes[1])) continue;
    bool other = false, near = false;
    for (uint k = 0; k < 3; ++k) {
      other = other || is_child(vertices[k], fold) != child;
      near = near || is_near(vertices[k], fold);
    }
    add_fold_triangle(corners[0], corners[1], corners[2], axes[2], axes[0], axes[1], other, near, found);
  }
}

void main() {
  uint vertex = gl_GlobalInvocationID.x, at = 3 * (push.vertex_count * gl_GlobalInvocationID.y + vertex);
  bool can_move = vertex < push.vertex_count, stands = true;
  float own[3] = float[3](0.0, 0.0, 0.0), before[3], normal[3], point[3], way[3];
  for (uint i = 0; i < 3 && can_move; ++i) {
    own[i] = current[at + i];
    before[i] = posed[at + i];
    normal[i] = normals[at + i];
    precise float outside = own[i] + kFoldOffset * normal[i];
    point[i] = outside;
    stands = stands && own[i] == before[i];
    moved[at + i] = own[i];
  }
  can_move = can_move && (push.step == 0 || !stands);
  float least = 3.4e38;
  for (uint fold = 0; fold < push.fold_count; ++fold) {
    float axes[3][3], spans[3][2];  // of u, w and n
    uint weight = push.component_count * gl_GlobalInvocationID.y + push.component + 3 * fold;
    for (uint i = 0; i < 3; ++i) axes[2][i] = weights[weight + i];
    float squared = dot_product(axes[2], axes[2]);
    if (!(squared > 0.0)) continue;
    fold_axes(axes[2], axes[0], axes[1]);
    find_spans(own, float[3](0.0, 0.0, 0.0), axes, spans);
    bool is_member = can_move && is_near(vertex, fold);
    if (gather_members(is_member, spans) == 0) continue;
    uint between = find_seen(fold, axes);
    if ((between & kBetween) != kBetween && (between >> kChildShift) != kBetween) continue;
    bool child = is_member && is_child(vertex, fold);
    float facing = is_member ? dot_product(normal, axes[2]) : 0.0;
    bool looks = is_member && (child ? facing < 0.0 : facing > 0.0) &&
                 (between >> (child ? kChildShift : 0) & kBetween) == kBetween;
    float found[8] = float[8](0.0, 0.0, 0.0, 0.0, 3.4e38, -3.4e38, 3.4e38, -3.4e38);
    for (uint first = 0; first < large_box_count(push.triangle_count); first += kWorkgroupSize) {
      gather_boxes(first, axes);
      for (uint slot = 0; slot < met_count && looks; ++slot) {
        float box_spans[3][2];
        find_box_spans(met[slot], axes, box_spans);
        if (meet(box_spans, spans)) add_box(met[slot], point, axes, fold, child, found);
      }
    }
    float depth = fold_depth(found, child, kFoldOffset * facing), size = sqrt(squared);
    if (!(depth > 0.0) || !(depth / size < least)) continue;
    least = depth / size;
    float share = (child ? 0.5 : -0.5) * min(size, 1.0) * depth / squared;
    for (uint i = 0; i < 3; ++i) way[i] = share * axes[2][i];
  }
  if (least == 3.4e38) return;
  float to_there[3];
  fold_step(way, before, own, push.limit, to_there);
  for (uint i = 0; i < 3; ++i) moved[at + i] = to_there[i];
}
