// Oklab (Ottosson 2020), a space in which distances are those that are seen.
#pragma once

#include <array>

namespace bodyopt {

using Oklab = std::array<double, 3>;  // lightness 0..1, a, b

// From chroma and hue (degrees).
Oklab oklab(double lightness, double chroma, double hue);

// Linear RGB; what a screen cannot show is clamped.
std::array<float, 3> linear_rgb(const Oklab& colour);

}  // namespace bodyopt
