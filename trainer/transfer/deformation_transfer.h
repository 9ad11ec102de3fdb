// Deformation transfer (Sumner and Popovic 2004) of un-posed displacements, between two skins of the same triangles.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "base/linear_algebra.h"
#include "geometry/hat_gradients.h"

namespace bodyopt {

// How far a displacement reaches.
enum class TransferSize {
  local,  // by the local size of the target: a thin arm gets thin bulges
  source  // in metres, as on the source
};

// The gradient D of the source's displacement, with the normal's change made linear, is wanted on the target's
// triangles:
//   H = D - (D^T n) n^T  (on the source),  sum_t area_t |grad d' - H|^2 + sum_i area_i / reach^2 |d'_i - s_i d_i|^2
//   least
// over the target's displacements d'. The target's own normals drop out, as they may move freely (Botsch and others
// 2006). s_i: local size of the target over that of the source. The second term settles where the whole stands, which
// gradients do not tell, and keeps small errors from adding up along a body; `reach` is a tenth of the target's
// extent. The result is linear in the displacements, and zero of zero. One factorisation, made on construction.
class DeformationTransfer {
 public:
  // V x 3 each, metres, in the same axes; T x 3.
  DeformationTransfer(const Positions& source, const Positions& target, const Triangles& triangles, TransferSize size);

  // V x 3, source, to V x 3, target; metres. On any thread.
  Positions operator()(const Positions& displacements) const;

 private:
  struct TrianglePair {
    HatGradients source, target;
    double scale = 1;  // of the gradient
  };

  const Triangles triangles_;
  std::vector<TrianglePair> pairs_;
  Eigen::VectorXd anchors_;  // V: area / reach^2
  Eigen::VectorXd sizes_;    // V: s
  SparseSolver solver_;
};

}  // namespace bodyopt
