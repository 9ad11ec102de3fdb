// Finds the shape without net forces: L-BFGS in a constant Laplacian metric (Liu, Bouaziz, Kavan 2017, "Quasi-Newton
// methods for real-time simulation of hyperelastic materials").
#pragma once

#include <Eigen/SparseCholesky>

#include "trainer/simulate/elastic_body.h"

namespace bodyopt {

struct SolveResult {
  double residual = 0;  // |net nodal force| / |element forces|; 0 where neither is above rounding
  int iterations = 0;
  int inverted = 0;  // tets without positive volume in the start; the solver does not move then
};

// Const after construction: several threads may solve at once.
class EquilibriumSolver {
 public:
  // Throws Error(mismatch) when bones do not hold every piece of the body.
  explicit EquilibriumSolver(const ElasticBody& body);

  // Moves x (N x 3, posed, metres) until the residual is below `tolerance` or `most_iterations` are done.
  SolveResult solve(Positions& x, const Drive& drive, double tolerance, int most_iterations) const;

 private:
  const ElasticBody& body_;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> metric_;
};

}  // namespace bodyopt
