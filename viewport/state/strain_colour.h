// The colour of a muscle fibre's strain.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace bodyopt::viewport {

constexpr float kFullStrain = 1.0f / 3;  // of the fullest colours

// Blue where shorter, yellow at rest, red where longer. sRGB and alpha, red in the lowest byte.
inline std::uint32_t strain_colour(float strain) {
  const auto packed = [](double red, double green, double blue) {
    const auto byte = [](double value) {
      return static_cast<std::uint32_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
    };
    return byte(red) | byte(green) << 8 | byte(blue) << 16 | 0xff000000u;
  };
  const double t = std::clamp(static_cast<double>(strain / kFullStrain), -1.0, 1.0), s = std::abs(t);
  return t < 0 ? packed(0.93 - 0.80 * s, 0.82 - 0.25 * s, 0.45 + 0.55 * s)
               : packed(0.93 + 0.07 * s, 0.82 - 0.60 * s, 0.45 - 0.30 * s);
}

}  // namespace bodyopt::viewport
