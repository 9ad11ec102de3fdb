// What the kernels of conjugate gradients share. One source for GLSL and C++.
#ifndef BODYOPT_CONJUGATE_H
#define BODYOPT_CONJUGATE_H

#include "one_source.h"

#ifdef __cplusplus
namespace bodyopt {
#endif

// a / b; 0 where b is not above 0, or so small that the quotient means nothing: the residual is gone, and the iteration
// stands still.
BODYOPT_FUNCTION float conjugate_ratio(float a, float b) {
  if (!(b >= 1.2e-38f)) return 0.0f;  // what is smaller is subnormal
  float ratio = a / b;
  return -3.4e38f <= ratio && ratio <= 3.4e38f ? ratio : 0.0f;
}

#ifdef __cplusplus
}  // namespace bodyopt
#endif
#endif
