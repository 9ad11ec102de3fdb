// Shapes that depend on where the motion came from.
#pragma once

#include "tests/curate/curated_limb.h"

namespace bodyopt {

// What real hysteresis is like: smooth over the skin, of the sweep's direction, different in takes; 3 mm RMS.
inline Positions with_history(const Character& character, int take, int frame, const Positions& truth) {
  const double direction = frame <= 21 ? 1 : -1;
  Positions field(truth.rows(), 3);
  for (Eigen::Index v = 0; v < truth.rows(); ++v) {
    const double z = character.vertices(v, 2);
    field.row(v) << std::cos(9 * z + take), std::sin(7 * z), std::cos(5 * z + 2 * take);
  }
  field *= 0.003 / std::sqrt(field.rowwise().squaredNorm().mean());
  return truth + direction * field;
}

}  // namespace bodyopt
