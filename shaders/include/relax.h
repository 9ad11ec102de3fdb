// Evens out skin that is compressed along itself. One source for GLSL and C++.
#ifndef BODYOPT_RELAX_H
#define BODYOPT_RELAX_H

#include "vectors.h"

#ifdef __cplusplus
namespace bodyopt {
#endif

// Sums around a vertex: the ways on which the triangles would get back what they lost, times their weights; the
// weights. Then the area vectors, their lengths, and those at rest; areas are twice what they are.
const int kRelaxWay = 0, kRelaxWeight = 3, kRelaxNormal = 4, kRelaxArea = 7, kRelaxRest = 8;

// Adds one triangle: p and q, its other corners counter-clockwise, as seen from the vertex, now and at rest. Its area
// grows by half the length of its edge times how far the vertex goes away from that. That way turns round where the
// triangle turns over. So what has less than a quarter of its area at rest counts the less, the smaller it is.
BODYOPT_FUNCTION void add_relax_corner(BODYOPT_IN_ARRAY(p, 3), BODYOPT_IN_ARRAY(q, 3), BODYOPT_IN_ARRAY(rest_p, 3),
                                       BODYOPT_IN_ARRAY(rest_q, 3), BODYOPT_INOUT_ARRAY(sums, 9)) {
  float normal[3], rest_normal[3], edge[3], away[3];
  cross_product(p, q, normal);
  cross_product(rest_p, rest_q, rest_normal);
  BODYOPT_PRECISE float squared = dot_product(normal, normal), rest_squared = dot_product(rest_normal, rest_normal);
  float area = sqrt(squared), rest_area = sqrt(rest_squared);
  for (int i = 0; i < 3; ++i) edge[i] = q[i] - p[i];
  cross_product(normal, edge, away);
  float lost = (rest_area - area) / max(max(area, 0.25f * rest_area), 1e-20f);
  for (int i = 0; i < 3; ++i) {
    BODYOPT_PRECISE float way = lost * away[i];
    sums[kRelaxWay + i] += way;
    sums[kRelaxNormal + i] += normal[i];
  }
  sums[kRelaxWeight] += dot_product(edge, edge);
  sums[kRelaxArea] += area;
  sums[kRelaxRest] += rest_area;
}

// The place of a vertex after a step, no further than about a quarter of an edge, of which `shown` (0 to 1) is shown.
// What does not move keeps its bits. The less the triangles agree on a plane, the less it moves, which keeps it
// continuous where they lie on each other.
BODYOPT_FUNCTION void relax_step(BODYOPT_IN_ARRAY(sums, 9), BODYOPT_IN_ARRAY(current, 3), float shown,
                                 BODYOPT_OUT_ARRAY(moved, 3)) {
  for (int i = 0; i < 3; ++i) moved[i] = current[i];
  float rest = sums[kRelaxRest], lost = rest > 0.0f ? 1.0f - sums[kRelaxArea] / rest : 0.0f;
  float way[3], normal[3];
  for (int i = 0; i < 3; ++i) normal[i] = sums[kRelaxNormal + i];
  BODYOPT_PRECISE float squared = dot_product(normal, normal);
  float flatness = squared > 1e-30f ? min(squared / (sums[kRelaxArea] * sums[kRelaxArea]), 1.0f) : 0.0f;
  float amount = shown * flatness * min(max(5.0f * (lost - 0.1f), 0.0f), 1.0f);
  if (!(amount > 0.0f) || !(sums[kRelaxWeight] > 0.0f)) return;
  for (int i = 0; i < 3; ++i) way[i] = sums[kRelaxWay + i] / sums[kRelaxWeight];
  BODYOPT_PRECISE float out_of_plane = dot_product(way, normal);
  float share = out_of_plane / squared;
  for (int i = 0; i < 3; ++i) way[i] -= share * normal[i];
  BODYOPT_PRECISE float length2 = dot_product(way, way), most2 = 0.04f * sums[kRelaxWeight];
  float bounded = 0.5f * amount * (length2 > most2 ? sqrt(most2 / length2) : 1.0f);
  for (int i = 0; i < 3; ++i) {
    BODYOPT_PRECISE float x = current[i] + bounded * way[i];
    moved[i] = x;
  }
}

#ifdef __cplusplus
}  // namespace bodyopt
#endif
#endif
