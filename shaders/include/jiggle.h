// Shared by the kernels of a jiggle step. One source for GLSL and C++, one order of operations: the same bits.
#ifndef BODYOPT_JIGGLE_H
#define BODYOPT_JIGGLE_H

#include "layout.h"
#include "one_source.h"

#ifdef __cplusplus
#include <cmath>
namespace bodyopt {
using std::sqrt;
#endif

// R x, R row-major: from a node's frame to the world.
BODYOPT_FUNCTION void turn(BODYOPT_IN_ARRAY(r, 9), BODYOPT_IN_ARRAY(x, 3), BODYOPT_OUT_ARRAY(y, 3)) {
  for (int i = 0; i < 3; ++i) {
    BODYOPT_PRECISE float value = r[3 * i] * x[0] + r[3 * i + 1] * x[1] + r[3 * i + 2] * x[2];
    y[i] = value;
  }
}

// R^T x: from the world to a node's frame.
BODYOPT_FUNCTION void turn_back(BODYOPT_IN_ARRAY(r, 9), BODYOPT_IN_ARRAY(x, 3), BODYOPT_OUT_ARRAY(y, 3)) {
  for (int i = 0; i < 3; ++i) {
    BODYOPT_PRECISE float value = r[i] * x[0] + r[3 + i] * x[1] + r[6 + i] * x[2];
    y[i] = value;
  }
}

// The share of a displacement of this squared length that is shown: all of it up to half the limit. From there on s
// limits become 1 - 1 / (4 s), which goes on with the same slope and never reaches the limit.
BODYOPT_FUNCTION float limited_share(float squared, float limit) {
  if (4.0f * squared <= limit * limit) return 1.0f;
  BODYOPT_PRECISE float inverse = limit / sqrt(squared);
  BODYOPT_PRECISE float share = inverse * (1.0f - 0.25f * inverse);
  return share;
}

// Right side of a node, in its frame: velocity_weight m (v + d R^T g) + displacement_weight inertia u.
BODYOPT_FUNCTION void node_right_side(JiggleNode node, JiggleStepPush step, BODYOPT_IN_ARRAY(r, 9),
                                      BODYOPT_IN_ARRAY(u, 3), BODYOPT_IN_ARRAY(v, 3),
                                      BODYOPT_OUT_ARRAY(right_side, 3)) {
  float gravity[3], local_gravity[3];
  gravity[0] = step.gravity_x;
  gravity[1] = step.gravity_y;
  gravity[2] = step.gravity_z;
  turn_back(r, gravity, local_gravity);
  BODYOPT_PRECISE float of_velocity = step.velocity_weight * node.mass;
  BODYOPT_PRECISE float of_displacement = step.displacement_weight * node.inertia;
  for (int i = 0; i < 3; ++i) {
    BODYOPT_PRECISE float value = of_velocity * (v[i] + step.stage * local_gravity[i]) + of_displacement * u[i];
    right_side[i] = value;
  }
}

#ifdef __cplusplus
}  // namespace bodyopt
#endif
#endif
