// What holds the inside of a body.
#pragma once

#include "trainer/dynamics/dynamics_tets.h"
#include "trainer/simulate/metric.h"

namespace bodyopt {

// Characters bring no ribs and no pelvis, and bones found along joints are thin where a trunk is wide: tissue deeper
// under the skin than `flesh` (metres, of every node) is held as bone is, fully from a quarter deeper on. stiffness:
// N/m per cubic metre. -> N x N, N/m.
SparseMatrix core_springs(const Positions& vertices, const Triangles& triangles, const Cage& cage,
                          const Eigen::VectorXd& flesh, double stiffness);

}  // namespace bodyopt
