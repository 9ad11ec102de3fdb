// What tangents know of a skin, whatever its pose is.
#pragma once

#include <span>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

// Empty where no texture coordinates were given.
struct TangentTables {
  std::vector<TangentVertex> vertices;  // O
  std::vector<TangentCorner> corners;   // those of output vertices of one place and one texture coordinate once
};

// texture: O x 2, finite; empty: none. As in MikkTSpace, triangles belong together where place and texture coordinates
// agree, and where they are mirrored alike; but an output vertex has one tangent: of the triangles around it those have
// their way that hold the larger angle at rest. Triangles without an area on the texture, and those of which two
// corners are at one place at rest, have no part in it.
TangentTables tangent_tables(const MeshTable& mesh, std::span<const float> texture);

}  // namespace bodyopt
