// Joint weights inside the body.
#pragma once

#include "assets/characters/character.h"
#include "trainer/simulate/metric.h"
#include "trainer/tets/cage.h"

namespace bodyopt::trainer {

// Joint weights of every node, N x J: rows sum to one.
using NodeWeights = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Extends skin weights inwards, N x J: for each joint the minimum of 1/2 w.laplacian w + bone springs + skin. Springs
// pull each bone's own weight to one. Vertices of the skin pull the weights of their tets, blended where they lie, to
// their own. `springs` (N x N) and `bone_share` (N x J, row sums of springs by joint) may be zero. Rows are clamped to
// 0 and normalised.
NodeWeights carry_through(const Character& character, const Cage& cage, const SparseMatrix& laplacian,
                          const SparseMatrix& springs, const NodeWeights& bone_share);

}  // namespace bodyopt::trainer
