// A number as the basis stores it: a half that is normal or 0, so that what is fitted is fitted to what will run.
#pragma once

#include <algorithm>
#include <cmath>

#include "runtime/core/half.h"

namespace bodyopt {

inline double stored_half(double value) {
  const double largest{float_from_half(kLargestHalf)}, smallest{float_from_half(kSmallestNormalHalf)};
  const float clamped = static_cast<float>(std::clamp(value, -largest, largest));
  const double rounded{float_from_half(half_from_float(clamped))};
  return std::abs(rounded) < smallest ? 0 : rounded;
}

}  // namespace bodyopt
