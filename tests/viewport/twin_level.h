// A proxy for tests that is as fine as its character.
#pragma once

#include "runtime/basis/levels.h"

namespace bodyopt::testing {

// A level that is the character itself: each vertex is carried by one of its own triangles.
inline Level twin(const Basis& basis) {
  Level level{basis, {std::vector<CarriedPoint>(basis.mesh.output_count()), 1e-6f}};
  const std::vector<std::uint32_t>& corners = basis.mesh.output_triangles;
  for (std::uint32_t k = 0; k < corners.size(); ++k) {
    const auto weight = [&](std::uint32_t corner) { return static_cast<std::uint8_t>(k % 3 == corner ? 255 : 0); };
    level.carried.points[corners[k]] = {k / 3, weight(1), weight(2), 0, 0, 0};
  }
  return level;
}

}  // namespace bodyopt::testing
