// Tetrahedra inside a closed skin.
#pragma once

#include <Eigen/Core>

#include "trainer/dataset/character.h"

namespace bodyopt {

struct TetMesh {
  Positions nodes;  // N x 3, rest space, metres; the first V are the skin's welded vertices, unmoved
  Eigen::Matrix<int, Eigen::Dynamic, 4, Eigen::RowMajor> tets;  // positive volume
  double worst_quality = 0;                                     // smallest mean-ratio quality, 0 (flat) .. 1 (regular)
};

// Netgen's nglib on the welded skin (which must be closed and free of self-intersections). `size` is the largest edge
// wanted inside, metres. Throws Error(mismatch) naming the cause when the skin cannot be filled.
TetMesh tetrahedralise(const Positions& vertices, const Triangles& triangles, double size);

// Edges from corner 0 to corners 1..3 as columns, metres; their determinant is six times the tet's volume.
Eigen::Matrix3d tet_edges(const TetMesh& mesh, Eigen::Index tet);

}  // namespace bodyopt
