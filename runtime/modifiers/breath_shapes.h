// The shapes that a learnt breath is made of.
#pragma once

#include <array>
#include <cstddef>

namespace bodyopt {

// The full breath, then a quarter, a half and three quarters of it while it comes in, and the same while it goes out.
inline constexpr std::size_t kBreathShapes = 7;

// The share of each that is shown where a breath is filled by 0 to 1: linear from one to the next.
inline std::array<double, kBreathShapes> breath_shapes(double filled, bool comes_in) {
  std::array<double, kBreathShapes> shares{};
  const double quarters = 4 * filled;
  for (std::size_t k = 1; k <= 4; ++k) {
    const double away =
        quarters > static_cast<double>(k) ? quarters - static_cast<double>(k) : static_cast<double>(k) - quarters;
    if (away < 1) shares[k == 4 ? 0 : comes_in ? k : k + 3] = 1 - away;
  }
  return shares;
}

}  // namespace bodyopt
