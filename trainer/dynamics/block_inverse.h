// Makes block inverses.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "geometry/mesh.h"
#include "runtime/basis/dynamics.h"

namespace bodyopt::trainer {

// Nested dissection: a graph's nodes in the order in which they are eliminated, as a binary tree of fronts.

// Neighbours of every node.
using Graph = std::vector<std::vector<int>>;

struct DissectedFront {
  std::vector<int> own;       // nodes eliminated here; none where a plane cuts no edge
  std::vector<int> boundary;  // nodes of fronts above that own or boundary nodes of fronts below touch, ascending
  int children[2] = {-1, -1};
  int level = 0;  // above those of its children; leaves are 0
};

// George 1973, by geometry: planes halve the nodes down to 32 or fewer. Of several directions it takes that with the
// smallest vertex cover of its cut. Children come before parents. A function of its arguments alone.
std::vector<DissectedFront> dissect(const Graph& graph, const Positions& points);

// The unknowns of a system: `components` of each of some nodes. Unknown components * i + c of the matrix belongs to
// node i of `points`. It is number components * nodes[i] + c of the block inverse, which has node_count nodes.
struct InverseNodes {
  const Positions& points;  // n x 3, metres: only their order along lines matters
  std::vector<int> nodes;   // n, different
  int node_count = 0;
};

// Factorises a symmetric positive definite matrix (both halves stored) in double precision and rounds the dense blocks
// to single. Throws Error(mismatch) where the matrix is not positive definite. A function of its arguments alone.
BlockInverse invert(const Eigen::SparseMatrix<double>& matrix, const InverseNodes& nodes, int components);

// Inverts the matrix of all nodes.
BlockInverse invert(const Eigen::SparseMatrix<double>& matrix, const Positions& points, int components);

}  // namespace bodyopt::trainer
