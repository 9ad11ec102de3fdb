// Joint weights inside the body.
#pragma once

#include "assets/character.h"
#include "trainer/simulate/metric.h"
#include "trainer/tets/cage.h"

namespace bodyopt {

// Joint weights of every node, N x J: rows sum to one.
using NodeWeights = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Skin weights carried inwards: on the skin they are the character's, inside they are the joint-wise minimum of
// 1/2 w.laplacian w + bone springs pulling each bone's own weight to one. `springs` (N x N) and `bone_share` (N x J,
// row sums of springs by joint) may be zero. Rows are clamped to 0 and normalised.
NodeWeights carry_inwards(const Character& character, const SparseMatrix& laplacian, const SparseMatrix& springs,
                          const NodeWeights& bone_share);

// The same for a cage, whose nodes are not the skin's vertices: every vertex pulls the weights of its tet, blended
// where it lies, towards its own.
NodeWeights carry_through(const Character& character, const Cage& cage, const SparseMatrix& laplacian,
                          const SparseMatrix& springs, const NodeWeights& bone_share);

}  // namespace bodyopt
