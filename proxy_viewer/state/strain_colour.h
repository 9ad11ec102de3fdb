// The colour of a muscle fibre's strain.
#pragma once

#include <cstdint>

namespace bodyopt {

constexpr float kFullStrain = 1.0f / 3;  // of the fullest colours

// Blue where shorter, yellow at rest, red where longer. sRGB and alpha, red in the lowest byte.
std::uint32_t strain_colour(float strain);

}  // namespace bodyopt
