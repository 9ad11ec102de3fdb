#include "draw/heat_colour.h"

#include <algorithm>
#include <iterator>

#include "draw/oklab.h"

namespace bodyopt {
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

}  // namespace bodyopt
