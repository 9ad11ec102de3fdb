#include "draw/colours.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace bodyopt::draw {
namespace {

// Lightness falls and the hue (degrees) turns one way, so that the order of errors can be read without the colour bar.
struct Stop {
  double t, lightness, chroma, hue;
};
constexpr Stop kStops[] = {{0.00, 0.797, 0.017, 77},
                           {0.18, 0.78, 0.145, 90},
                           {0.42, 0.70, 0.165, 65},
                           {0.70, 0.56, 0.200, 32},
                           {1.00, 0.36, 0.155, -10}};

Stop at(double t) {
  const Stop* upper = std::upper_bound(std::begin(kStops), std::end(kStops) - 1, t,
                                       [](double value, const Stop& stop) { return value < stop.t; });
  const Stop &a = upper[-1], &b = upper[0];
  const double s = (t - a.t) / (b.t - a.t);
  return {t, a.lightness + s * (b.lightness - a.lightness), a.chroma + s * (b.chroma - a.chroma),
          a.hue + s * (b.hue - a.hue)};
}

}  // namespace

std::array<float, 3> heat_colour(float t) {
  const Stop stop = at(t > 0 ? std::min(1.0, static_cast<double>(t)) : 0.0);  // also for NaN
  return linear_rgb(oklab(stop.lightness, stop.chroma, stop.hue));
}

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

}  // namespace bodyopt::draw
