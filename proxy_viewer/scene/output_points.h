// Points of a character's file, in the order of its mesh.
#pragma once

#include <span>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

// O x 3, output vertex order, to V x 3.
std::vector<float> vertices_of(const MeshTable& mesh, std::span<const float> output);

// V x 3, to O x 3.
std::vector<float> output_of(const MeshTable& mesh, std::span<const float> vertices);

// Of the skin at a vertex, output vertex order: unit, outwards; zero where the triangles around it have no area.
Vec3 normal_at(const MeshTable& mesh, std::span<const float> output, std::uint32_t vertex);

}  // namespace bodyopt
