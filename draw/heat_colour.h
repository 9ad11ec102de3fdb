#pragma once

#include <array>

namespace bodyopt {

// Colour of a heat map for t in 0..1 (0: clay-neutral, 1: hot), linear RGB; perceptually ordered.
std::array<float, 3> heat_colour(float t);

}  // namespace bodyopt
