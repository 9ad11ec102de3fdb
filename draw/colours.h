// Colours as screens and files have them, and such as differ as seen.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace bodyopt::draw {

// Colour of a heat map for t in 0..1 (0: clay-neutral, 1: hot), linear RGB; perceptually ordered.
std::array<float, 3> heat_colour(float t);

// Ottosson 2020: a space in which distances are those that are seen.
using Oklab = std::array<double, 3>;  // lightness 0..1, a, b

// From chroma and hue (degrees).
Oklab oklab(double lightness, double chroma, double hue);

// Linear RGB; what a screen cannot show is clamped.
std::array<float, 3> linear_rgb(const Oklab& colour);

// Encodes linear RGB; values below 0 and above 1 are clamped.
inline std::array<std::uint8_t, 3> srgb(const std::array<float, 3>& linear) {
  std::array<std::uint8_t, 3> result;
  for (std::size_t i = 0; i < 3; ++i) {
    const double c = std::clamp(static_cast<double>(linear[i]), 0.0, 1.0);
    const double encoded = c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
    result[i] = static_cast<std::uint8_t>(std::lround(255 * encoded));
  }
  return result;
}

// Linear light, 0 to 1, of a channel in sRGB (IEC 61966-2-1).
inline float linear(std::uint8_t encoded) {
  const float c = static_cast<float>(encoded) / 255;
  return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
}

}  // namespace bodyopt::draw
