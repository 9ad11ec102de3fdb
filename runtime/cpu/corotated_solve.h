// Quality mode of the jiggle: steps of conjugate gradients (Hestenes and Stiefel 1952) on the element-corotated
// operator, preconditioned by the block inverse. Where the body turns as one, the two are the same and a step is exact.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/basis/dynamics.h"
#include "runtime/core/executor.h"

namespace bodyopt::cpu {

// The operator at one frame. rotations of nodes N x 9, of tets T x 9.
struct CorotatedOperator {
  const TetTable& tets;
  const JiggleTable& jiggle;
  std::span<const float> rotations, tet_rotations;
};

// Resized as needed.
struct CorotatedScratch {
  std::vector<float> residual, y, direction, product, tractions, block;
};

// z0 = displacement_weight u + d^2 velocity_weight v, the solution without stiffness and damping: all 3N, in the nodes'
// frames.
void corotated_start(const JiggleStepPush& stage, std::span<const float> local_displacement,
                     std::span<const float> local_velocity, std::span<float> start);

// `solution`, z0 on entry, is z after a fixed number of iterations: every frame the same work. right_side, solution 3N,
// in the nodes' frames. A right side and a start of zeros give exactly zeros.
void corotated_solve(const CorotatedOperator& a, std::span<const float> right_side, std::uint32_t iterations,
                     CorotatedScratch& scratch, std::span<float> solution, Executor& threads = calling_thread());

}  // namespace bodyopt::cpu
