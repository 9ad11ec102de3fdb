#include "draw/oklab.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace bodyopt {

Oklab oklab(double lightness, double chroma, double hue) {
  const double angle = hue * std::numbers::pi / 180;
  return {lightness, chroma * std::cos(angle), chroma * std::sin(angle)};
}

std::array<float, 3> linear_rgb(const Oklab& colour) {
  const auto& [lightness, a, b] = colour;
  const double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3);
  const double m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3);
  const double s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
  const double rgb[3] = {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
                         -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
                         -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
  std::array<float, 3> result;
  for (std::size_t i = 0; i < 3; ++i) result[i] = static_cast<float>(std::clamp(rgb[i], 0.0, 1.0));
  return result;
}

}  // namespace bodyopt
