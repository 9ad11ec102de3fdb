// What a triangle says to a vertex that lies behind it where skin folds. One source for GLSL and C++.
#ifndef BODYOPT_FOLD_H
#define BODYOPT_FOLD_H

#include "jiggle.h"
#include "one_source.h"

#ifdef __cplusplus
namespace bodyopt {
#endif

const float kFoldTouch = 1e-5f;  // metres within which a vertex lies on a triangle
const float kFoldSoft = 1e-6f;   // square of the distance, metres, within which triangles are equally near

BODYOPT_FUNCTION float fold_dot(BODYOPT_IN_ARRAY(a, 3), BODYOPT_IN_ARRAY(b, 3)) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// The point of a triangle nearest to the origin (Ericson, Real-Time Collision Detection, 5.1.5).
BODYOPT_FUNCTION void nearest_of_triangle(BODYOPT_IN_ARRAY(a, 3), BODYOPT_IN_ARRAY(b, 3), BODYOPT_IN_ARRAY(c, 3),
                                          BODYOPT_OUT_ARRAY(nearest, 3)) {
  float ab[3], ac[3];
  for (int i = 0; i < 3; ++i) {
    ab[i] = b[i] - a[i];
    ac[i] = c[i] - a[i];
  }
  BODYOPT_PRECISE float d1 = -fold_dot(ab, a), d2 = -fold_dot(ac, a);
  BODYOPT_PRECISE float d3 = -fold_dot(ab, b), d4 = -fold_dot(ac, b);
  BODYOPT_PRECISE float d5 = -fold_dot(ab, c), d6 = -fold_dot(ac, c);
  BODYOPT_PRECISE float va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  float at_b = 0.0f, at_c = 0.0f;  // weights
  if (d1 <= 0.0f && d2 <= 0.0f) {
  } else if (d3 >= 0.0f && d4 <= d3) {
    at_b = 1.0f;
  } else if (vc <= 0.0f && d1 >= 0.0f && d3 <= 0.0f) {
    at_b = d1 - d3 > 0.0f ? d1 / (d1 - d3) : 0.0f;
  } else if (d6 >= 0.0f && d5 <= d6) {
    at_c = 1.0f;
  } else if (vb <= 0.0f && d2 >= 0.0f && d6 <= 0.0f) {
    at_c = d2 - d6 > 0.0f ? d2 / (d2 - d6) : 0.0f;
  } else if (va <= 0.0f && d4 >= d3 && d5 >= d6) {
    float edge = (d4 - d3) + (d5 - d6);
    at_c = edge > 0.0f ? (d4 - d3) / edge : 0.0f;
    at_b = 1.0f - at_c;
  } else {
    float sum = va + vb + vc;
    at_b = sum > 0.0f ? vb / sum : 0.0f;
    at_c = sum > 0.0f ? vc / sum : 0.0f;
  }
  for (int i = 0; i < 3; ++i) nearest[i] = a[i] + at_b * ab[i] + at_c * ac[i];
}

// a x b, added to a sum.
BODYOPT_FUNCTION void add_fold_cross(BODYOPT_IN_ARRAY(a, 3), BODYOPT_IN_ARRAY(b, 3), BODYOPT_INOUT_ARRAY(sum, 3)) {
  BODYOPT_PRECISE float x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
  sum[0] += x;
  sum[1] += y;
  sum[2] += z;
}

// Adds what a triangle, seen from a vertex at the origin with a normal of its own, says: weight times the way to it
// (pull[0..2]; none of a triangle that the vertex is in front of) and weight (pull[3]). The weight is that of the
// nearest, 1 / distance^4, and fades out towards the reach, where the vertex is beside the triangle more than behind or
// in front of it, and where the two do not face each other, so that what is pulled moves evenly while the pose does.
BODYOPT_FUNCTION void add_fold_pull(BODYOPT_IN_ARRAY(own, 3), BODYOPT_IN_ARRAY(a, 3), BODYOPT_IN_ARRAY(b, 3),
                                    BODYOPT_IN_ARRAY(c, 3), float reach, BODYOPT_INOUT_ARRAY(pull, 4)) {
  float nearest[3];
  nearest_of_triangle(a, b, c, nearest);
  BODYOPT_PRECISE float distance2 = fold_dot(nearest, nearest);
  if (!(distance2 < reach * reach)) return;
  float ab[3], ac[3], normal[3];
  for (int i = 0; i < 3; ++i) {
    ab[i] = b[i] - a[i];
    ac[i] = c[i] - a[i];
    normal[i] = 0.0f;
  }
  add_fold_cross(ab, ac, normal);
  BODYOPT_PRECISE float area2 = fold_dot(normal, normal), behind = fold_dot(normal, a);
  BODYOPT_PRECISE float own2 = fold_dot(own, own), alike = fold_dot(own, normal);
  if (!(area2 > 1e-20f) || !(own2 > 1e-20f)) return;
  float distance = sqrt(distance2), height = abs(behind) / sqrt(area2);
  float facing = (height + kFoldTouch) / (distance + kFoldTouch);
  float opposite = -alike / (sqrt(area2) * sqrt(own2));
  float share = min(max(2.5f * (facing - 0.5f), 0.0f), 1.0f) * min(max(2.5f * (opposite + 0.1f), 0.0f), 1.0f) *
                min(4.0f - 4.0f * distance / reach, 1.0f);
  float near = share * kFoldSoft / (distance2 + kFoldSoft), near2 = near * near, near4 = near2 * near2;
  float weight = near4 * near4;
  if (behind > 0.0f) {
    for (int i = 0; i < 3; ++i) pull[i] += weight * share * nearest[i];
  }
  pull[3] += weight;
}

// The place of a vertex after a step. `shown`: of all steps, in the last of them, 0 to 1; below 0 in the others. What
// does not move keeps its bits.
BODYOPT_FUNCTION void fold_step(BODYOPT_IN_ARRAY(pull, 4), BODYOPT_IN_ARRAY(posed, 3), BODYOPT_IN_ARRAY(current, 3),
                                float reach, float shown, BODYOPT_OUT_ARRAY(moved, 3)) {
  BODYOPT_PRECISE float step = pull[3] > 0.0f ? 0.5f / pull[3] : 0.0f;
  float way[3];
  for (int i = 0; i < 3; ++i) {
    moved[i] = current[i];
    if (pull[i] != 0.0f) moved[i] = current[i] + step * pull[i];
    way[i] = moved[i] - posed[i];
  }
  if (shown < 0.0f) return;
  BODYOPT_PRECISE float squared = fold_dot(way, way), taken = shown * limited_share(squared, reach);
  for (int i = 0; i < 3; ++i) {
    moved[i] = posed[i];
    if (taken * way[i] != 0.0f) moved[i] = posed[i] + taken * way[i];
  }
}

#ifdef __cplusplus
}  // namespace bodyopt
#endif
#endif
