// Converts points between the order of a character's file (output vertices, several a place at seams) and that of the
// runtime (one vertex a place).
#pragma once

#include <span>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

// O x 3, output vertex order, to V x 3.
std::vector<float> vertices_of(const MeshTable& mesh, std::span<const float> output, std::vector<float> vertices = {});

// V x 3, to O x 3.
std::vector<float> output_of(const MeshTable& mesh, std::span<const float> vertices);

}  // namespace bodyopt
