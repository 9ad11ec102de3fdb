// Linear elasticity and lumped masses of tetrahedra with linear shape functions.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "trainer/simulate/metric.h"

namespace bodyopt {

// K, 3N x 3N, N/m, unknown 3 x node + axis: K_ab = volume (lambda dN_a dN_b^T + mu dN_b dN_a^T + mu (dN_a . dN_b) I).
// One material per tet.
SparseMatrix elastic_stiffness(const TetMesh& mesh, const std::vector<TetMaterial>& materials);

// N, kg: a quarter of each tet's. density: kg/m^3.
Eigen::VectorXd lumped_mass(const TetMesh& mesh, double density);

}  // namespace bodyopt
