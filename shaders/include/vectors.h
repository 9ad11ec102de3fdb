// Products of vectors of three numbers. One source for GLSL and C++.
#ifndef BODYOPT_VECTORS_H
#define BODYOPT_VECTORS_H

#include "one_source.h"

#ifdef __cplusplus
namespace bodyopt {
#endif

BODYOPT_FUNCTION float dot_product(BODYOPT_IN_ARRAY(a, 3), BODYOPT_IN_ARRAY(b, 3)) {
  BODYOPT_PRECISE float sum = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  return sum;
}

BODYOPT_FUNCTION void cross_product(BODYOPT_IN_ARRAY(a, 3), BODYOPT_IN_ARRAY(b, 3), BODYOPT_OUT_ARRAY(c, 3)) {
  BODYOPT_PRECISE float x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
  c[0] = x;
  c[1] = y;
  c[2] = z;
}

// v of length 1; 0 where it has next to none.
BODYOPT_FUNCTION void make_unit(BODYOPT_INOUT_ARRAY(v, 3)) {
  float length = sqrt(dot_product(v, v));
  float scale = length > 1e-18f ? 1.0f / length : 0.0f;
  for (int i = 0; i < 3; ++i) v[i] *= scale;
}

#ifdef __cplusplus
}  // namespace bodyopt
#endif
#endif
