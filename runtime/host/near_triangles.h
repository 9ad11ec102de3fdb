// A skin's triangles in the order of its vertices: what is found for a triangle stands near what is found for its
// vertices, so that threads which share a frame read little that another one wrote.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

struct NearTriangles {
  std::vector<std::uint32_t> triangles;  // T x 3, vertices of the skin, those with the lowest first
  // As MeshTable's, in these numbers; those of a vertex stay in the mesh's order: a sum over them has the same bits.
  std::vector<std::uint32_t> vertex_triangles;
};

NearTriangles near_triangles(const MeshTable& mesh);

}  // namespace bodyopt
