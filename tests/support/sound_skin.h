// What a closed manifold is, told from its triangles alone.
#pragma once

#include <cstddef>
#include <string>

#include "geometry/mesh.h"

namespace bodyopt::testing {

// V - E + F.
long euler_characteristic(const Triangles& triangles, std::size_t vertices);

// Where the triangles are not those of a closed manifold; nothing where they are.
std::string manifold_defect(const Triangles& triangles, std::size_t vertices);

}  // namespace bodyopt::testing
