// What push-out knows of a skin, whatever its pose is.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

struct FoldTables {
  // T x 3: the skin's, in an order in which each kBoxTriangles of them lie together at rest.
  std::vector<std::uint32_t> triangles;
  // Of each of V vertices words of a bit for each fold whose reach it lies within, in space and along the bones, and as
  // many of a bit for each whose joint, or one below that, holds it: the child's side. Then of each box of triangles
  // words of a bit for each fold of whose parent's side a corner is, and as many of a bit for each of whose child's
  // side one is.
  std::vector<std::uint32_t> sides;
};

// Nothing where there is no push-out.
FoldTables fold_tables(const Basis& basis);
// Their parts: triangles in such an order, and what boxes of triangles add to the vertices' sides.
std::vector<std::uint32_t> boxed_triangles(const MeshTable& mesh);
void add_box_sides(std::size_t words, FoldTables& tables);

}  // namespace bodyopt
