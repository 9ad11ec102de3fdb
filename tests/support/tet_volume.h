// The volume that tets fill.
#pragma once

#include "geometry/tet_mesh.h"

namespace bodyopt {

// Cubic metres.
inline double volume(const TetMesh& mesh) {
  double sum = 0;
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) sum += tet_edges(mesh, t).determinant() / 6;
  return sum;
}

}  // namespace bodyopt
