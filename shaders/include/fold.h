// Finds skin that has crossed skin in a fold. One source for GLSL and C++.
//
// The sides of a fold are the skin that its joint or one below it holds (the child's) and all other (the parent's). Its
// normal n points from the parent's side to the child's. A vertex lies in the other side's skin where, on balance, the
// line along n leaves that body above it and enters it below. The fold takes it out only where it would come out at
// skin that the fold is of: a hand in a thigh stays.
#ifndef BODYOPT_FOLD_H
#define BODYOPT_FOLD_H

#include "layout.h"
#include "vectors.h"

#ifdef __cplusplus
namespace bodyopt {
#endif

// So many boxes of triangles share a large one; the large ones stand after the others.
const uint kLargeBox = 16u;
BODYOPT_FUNCTION uint small_box_count(uint triangle_count) {
  return (triangle_count + kBoxTriangles - 1u) / kBoxTriangles;
}
BODYOPT_FUNCTION uint large_box_count(uint triangle_count) {
  return (small_box_count(triangle_count) + kLargeBox - 1u) / kLargeBox;
}
BODYOPT_FUNCTION uint box_count(uint triangle_count) {
  return small_box_count(triangle_count) + large_box_count(triangle_count);
}

// Metres that a vertex is looked at outside of where it stands: skin that touches skin has not crossed it.
const float kFoldOffset = 1e-5f;

// Sums along a line: how often the body is left above the point, and entered below it, less the other way round. Then
// the same of the other side's body. Then the heights at which that is first left above, and last entered below (< 0).
// Then these two of skin near the fold alone.
const int kFoldAbove = 0, kFoldBelow = 1, kFoldOtherAbove = 2, kFoldOtherBelow = 3, kFoldLeft = 4, kFoldEntered = 5,
          kFoldNearLeft = 6, kFoldNearEntered = 7;

// Two axes across the normal, so that u x w points along it; none of the three is a unit.
BODYOPT_FUNCTION void fold_axes(BODYOPT_IN_ARRAY(n, 3), BODYOPT_OUT_ARRAY(u, 3), BODYOPT_OUT_ARRAY(w, 3)) {
  float x = abs(n[0]), y = abs(n[1]), z = abs(n[2]);
  float across[3];
  across[0] = x <= y && x <= z ? 1.0f : 0.0f;
  across[1] = x > y && y <= z ? 1.0f : 0.0f;
  across[2] = across[0] + across[1] > 0.0f ? 0.0f : 1.0f;
  cross_product(n, across, u);
  cross_product(n, u, w);
}

// The span that surely holds a box along an axis, from its middle and half edges (0 for a point).
BODYOPT_FUNCTION void fold_span(BODYOPT_IN_ARRAY(middle, 3), BODYOPT_IN_ARRAY(half_edge, 3), BODYOPT_IN_ARRAY(axis, 3),
                                BODYOPT_OUT_ARRAY(span, 2)) {
  float away = 0.0f, reach = 0.0f, sum = 0.0f, size = 0.0f;
  for (int i = 0; i < 3; ++i) {
    away += axis[i] * middle[i];
    reach += abs(axis[i]) * half_edge[i];
    sum += abs(axis[i] * middle[i]);
    size = max(size, abs(axis[i]));
  }
  float margin = 1e-5f * (reach + sum) + 4.0f * kFoldOffset * size;
  span[0] = away - reach - margin;
  span[1] = away + reach + margin;
}

// 1 where a triangle's edge, seen along the normal, crosses the point's half line along u to the left; -1 to the right.
// It is the same of an edge from either end, so that no line slips between triangles.
BODYOPT_FUNCTION float fold_edge(float from_u, float from_w, float to_u, float to_w) {
  if ((from_w > 0.0f) == (to_w > 0.0f)) return 0.0f;
  bool left = to_w > 0.0f;
  float low_u = left ? from_u : to_u, low_w = left ? from_w : to_w;
  float high_u = left ? to_u : from_u, high_w = left ? to_w : from_w;
  BODYOPT_PRECISE float side = low_u * high_w - high_u * low_w;
  if (!(side > 0.0f)) return 0.0f;
  return left ? 1.0f : -1.0f;
}

// Does a triangle, its corners relative to the point, surely lie to one side of the line?
BODYOPT_FUNCTION bool is_beside_fold_line(BODYOPT_IN_ARRAY(a, 3), BODYOPT_IN_ARRAY(b, 3), BODYOPT_IN_ARRAY(c, 3),
                                          BODYOPT_IN_ARRAY(w, 3)) {
  bool left = dot_product(w, a) > 0.0f;
  return left == (dot_product(w, b) > 0.0f) && left == (dot_product(w, c) > 0.0f);
}

// Adds a triangle, its corners relative to the point, to what is found along the line. Of the other side, and near the
// fold?
BODYOPT_FUNCTION void add_fold_triangle(BODYOPT_IN_ARRAY(a, 3), BODYOPT_IN_ARRAY(b, 3), BODYOPT_IN_ARRAY(c, 3),
                                        BODYOPT_IN_ARRAY(n, 3), BODYOPT_IN_ARRAY(u, 3), BODYOPT_IN_ARRAY(w, 3),
                                        bool other, bool near, BODYOPT_INOUT_ARRAY(found, 8)) {
  float au = dot_product(u, a), aw = dot_product(w, a), bu = dot_product(u, b), bw = dot_product(w, b),
        cu = dot_product(u, c), cw = dot_product(w, c);
  float leaves = fold_edge(au, aw, bu, bw) + fold_edge(bu, bw, cu, cw) + fold_edge(cu, cw, au, aw);
  if (leaves == 0.0f) return;
  float ah = dot_product(n, a), bh = dot_product(n, b), ch = dot_product(n, c);
  BODYOPT_PRECISE float at_a = bu * cw - cu * bw, at_b = cu * aw - au * cw, at_c = au * bw - bu * aw;
  BODYOPT_PRECISE float sum = at_a + at_b + at_c, weighted = at_a * ah + at_b * bh + at_c * ch;
  float height = sum != 0.0f ? weighted / sum : ah;
  height = min(max(height, min(ah, min(bh, ch))), max(ah, max(bh, ch)));
  float share = other ? 1.0f : 0.0f;
  if (height > 0.0f) {
    found[kFoldAbove] += leaves;
    found[kFoldOtherAbove] += share * leaves;
    if (other && leaves > 0.0f) {
      found[kFoldLeft] = min(found[kFoldLeft], height);
      if (near) found[kFoldNearLeft] = min(found[kFoldNearLeft], height);
    }
  } else {
    found[kFoldBelow] -= leaves;
    found[kFoldOtherBelow] -= share * leaves;
    if (other && leaves < 0.0f) {
      found[kFoldEntered] = max(found[kFoldEntered], height);
      if (near) found[kFoldNearEntered] = max(found[kFoldNearEntered], height);
    }
  }
}

// The depth of a vertex in the other side's skin, along n and in parts of its length. It is 0 outside, and where the
// vertex would come out at skin that is not near the fold. `offset`: of the point from the vertex, along n.
BODYOPT_FUNCTION float fold_depth(BODYOPT_IN_ARRAY(found, 8), bool is_child, float offset) {
  float least = min(min(found[kFoldAbove], found[kFoldBelow]), min(found[kFoldOtherAbove], found[kFoldOtherBelow]));
  if (!(least > 0.5f)) return 0.0f;
  if (is_child ? found[kFoldNearLeft] > found[kFoldLeft] : found[kFoldNearEntered] < found[kFoldEntered]) return 0.0f;
  return max(is_child ? found[kFoldLeft] + offset : -found[kFoldEntered] - offset, 0.0f);
}

// The place of a vertex that goes half its depth, as the other skin does; away from where it was posed `limit` at most.
BODYOPT_FUNCTION void fold_step(BODYOPT_IN_ARRAY(way, 3), BODYOPT_IN_ARRAY(posed, 3), BODYOPT_IN_ARRAY(current, 3),
                                float limit, BODYOPT_OUT_ARRAY(moved, 3)) {
  float whole[3];
  for (int i = 0; i < 3; ++i) whole[i] = current[i] + way[i] - posed[i];
  BODYOPT_PRECISE float squared = dot_product(whole, whole);
  float share = squared > limit * limit ? limit / sqrt(squared) : 1.0f;
  for (int i = 0; i < 3; ++i) {
    BODYOPT_PRECISE float x = posed[i] + share * whole[i];
    moved[i] = x;
  }
}

#ifdef __cplusplus
}  // namespace bodyopt
#endif
#endif
