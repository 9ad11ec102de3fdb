// The textbook way, to be compared with: projected Newton with a sparse direct factorisation at every step.
#pragma once

#include "trainer/simulate/bone_springs.h"
#include "trainer/simulate/lbfgs.h"
#include "trainer/simulate/muscle_fibres.h"
#include "trainer/simulate/tissue.h"

namespace bodyopt::bench {

// Tissue with its fibres active, and bone springs: the elastic problem without contact, skin and whole-muscle volume.
struct ElasticProblem {
  TetMesh mesh;
  std::vector<TetMaterial> tets;
  std::vector<FibreTet> fibres;
  Materials materials;
  std::vector<double> activation;  // per muscle
  SparseMatrix spring_stiffness;   // N x N
};

// The Hessian of the problem's energy at `nodes`, 3N x 3N: each tet's 9 x 9 block of dP/dF projected to positive
// semi-definite (Teran et al. 2005), springs as they are.
SparseMatrix projected_hessian(const ElasticProblem& problem, const Positions& nodes);

// Newton steps with backtracking until the residual (as minimise's) is `tolerance` or less, no step lowers the energy
// any more, or 200 are done. The residual returned belongs to the nodes returned.
MinimiseResult newton(const ElasticProblem& problem, const Objective& objective, double tolerance, Positions& nodes);

}  // namespace bodyopt::bench
