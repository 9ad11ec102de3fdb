// Makes block inverses.
#pragma once

#include <Eigen/SparseCore>

#include "geometry/mesh.h"
#include "runtime/basis/block_inverse.h"

namespace bodyopt {

// The unknowns of a system: `components` of each of some nodes. Unknown components * i + c of the matrix, which is that
// of node i of `points`, is number components * nodes[i] + c of the block inverse, which has node_count of them.
struct InverseNodes {
  const Positions& points;  // n x 3, metres: only their order along lines matters
  std::vector<int> nodes;   // n, different
  int node_count = 0;
};

// Factorises a symmetric positive definite matrix (both halves stored) in double precision and rounds the dense blocks
// to single. Throws Error(mismatch) where the matrix is not positive definite. A function of its arguments alone.
BlockInverse invert(const Eigen::SparseMatrix<double>& matrix, const InverseNodes& nodes, int components);

// Of all nodes.
BlockInverse invert(const Eigen::SparseMatrix<double>& matrix, const Positions& points, int components);

}  // namespace bodyopt
