// Which way a skin looks.
#pragma once

#include <span>

#include "runtime/basis/basis.h"

namespace bodyopt {

// Of the skin at a vertex, output vertex order: unit, outwards; zero where the triangles around it have no area.
Vec3 normal_at(const MeshTable& mesh, std::span<const float> output, std::uint32_t vertex);

}  // namespace bodyopt
