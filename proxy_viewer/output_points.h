// Points of a character's file, in the order of its mesh.
#pragma once

#include <span>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

// O x 3, output vertex order, to V x 3.
std::vector<float> vertices_of(const MeshTable& mesh, std::span<const float> output);

}  // namespace bodyopt
