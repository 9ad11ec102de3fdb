#include "tests/support/tet_volume.h"

#include <Eigen/LU>

namespace bodyopt {

double volume(const TetMesh& mesh) {
  double sum = 0;
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) sum += tet_edges(mesh, t).determinant() / 6;
  return sum;
}

}  // namespace bodyopt
