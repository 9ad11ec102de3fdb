// The colour of a muscle fibre's strain.
#pragma once

#include <cstdint>

namespace bodyopt {

// Blue where shorter, yellow at rest, red where longer; full at a third. sRGB and alpha, red in the lowest byte.
std::uint32_t strain_colour(float strain);

}  // namespace bodyopt
