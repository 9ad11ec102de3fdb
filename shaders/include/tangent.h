// The part of a triangle's corner in the tangent of its vertex, by MikkTSpace (Mikkelsen, "Simulation of Wrinkled
// Surfaces Revisited", 2008). One source for GLSL and C++.
#ifndef BODYOPT_TANGENT_H
#define BODYOPT_TANGENT_H

#include "layout.h"
#include "vectors.h"

#ifdef __cplusplus
namespace bodyopt {
#endif

// Radians, of a cosine from -1 to 1. Abramowitz and Stegun, "Handbook of Mathematical Functions", 4.4.46, is off by
// 2e-8 before roundings. A device's own may be off by 4,096 units in the last place.
BODYOPT_FUNCTION float angle_of_cosine(float cosine) {
  float x = abs(cosine);
  BODYOPT_PRECISE float series = -0.0012624911f;
  series = series * x + 0.0066700901f;
  series = series * x - 0.0170881256f;
  series = series * x + 0.0308918810f;
  series = series * x - 0.0501743046f;
  series = series * x + 0.0889789874f;
  series = series * x - 0.2145988016f;
  series = series * x + 1.5707963050f;
  BODYOPT_PRECISE float angle = sqrt(max(0.0f, 1.0f - x)) * series;
  return cosine < 0.0f ? 3.14159265f - angle : angle;
}

// The direction of v across the normal n.
BODYOPT_FUNCTION void across_normal(BODYOPT_IN_ARRAY(n, 3), BODYOPT_IN_ARRAY(v, 3), BODYOPT_OUT_ARRAY(u, 3)) {
  float along = dot_product(n, v);
  for (int i = 0; i < 3; ++i) {
    BODYOPT_PRECISE float across = v[i] - along * n[i];
    u[i] = across;
  }
  make_unit(u);
}

// Adds the triangle's tangent across the vertex's normal n, times the triangle's angle there, and as the fourth the
// angle itself. to_b, to_c: its edges.
BODYOPT_FUNCTION void add_corner(TangentCorner corner, BODYOPT_IN_ARRAY(n, 3), BODYOPT_IN_ARRAY(to_b, 3),
                                 BODYOPT_IN_ARRAY(to_c, 3), BODYOPT_INOUT_ARRAY(sum, 4)) {
  float tangent[3], b[3], c[3], of_triangle[3];
  for (int i = 0; i < 3; ++i) {
    BODYOPT_PRECISE float along = corner.along_b * to_b[i] + corner.along_c * to_c[i];
    of_triangle[i] = along;
  }
  across_normal(n, of_triangle, tangent);
  across_normal(n, to_b, b);
  across_normal(n, to_c, c);
  float angle = angle_of_cosine(max(-1.0f, min(1.0f, dot_product(b, c))));
  for (int i = 0; i < 3; ++i) {
    BODYOPT_PRECISE float more = sum[i] + angle * tangent[i];
    sum[i] = more;
  }
  sum[3] += angle;
}

// The least share of the angles that is left where triangles' tangents point to different sides. Below it roundings,
// the pose's too, would make up the direction.
const float kLeastTangent = 1e-5f;

// The tangent of a sum of corners, of length 1; 0 where their tangents vanish.
BODYOPT_FUNCTION void vertex_tangent(BODYOPT_IN_ARRAY(sum, 4), BODYOPT_OUT_ARRAY(tangent, 3)) {
  for (int i = 0; i < 3; ++i) tangent[i] = sum[i];
  float least = kLeastTangent * sum[3];
  if (dot_product(tangent, tangent) < least * least) {
    for (int i = 0; i < 3; ++i) tangent[i] = 0.0f;
  }
  make_unit(tangent);
}

#ifdef __cplusplus
}  // namespace bodyopt
#endif
#endif
