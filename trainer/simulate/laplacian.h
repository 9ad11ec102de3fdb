// The scalar FEM Laplacian of a tet mesh.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "trainer/simulate/tets.h"

namespace bodyopt {

// N x N, symmetric positive semi-definite: sum over tets of weight * volume * grad phi_i . grad phi_j. `weights` has
// one value per tet (a stiffness in Pa, or 1). Rows sum to 0.
Eigen::SparseMatrix<double> tet_laplacian(const TetMesh& mesh, const std::vector<double>& weights);

}  // namespace bodyopt
