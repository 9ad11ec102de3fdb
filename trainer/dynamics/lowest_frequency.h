// What keeps thin tips, and parts that no bone is in, from swinging slower than flesh does.
#pragma once

#include <string>
#include <vector>

#include "trainer/dynamics/jiggle.h"

namespace bodyopt {

// Tissue is linear: what swings slowly, goes far, a tip of 1 Hz a quarter of a metre under 1 g, and still further while
// a clip lasts. Every node's give, metres under 1 m/s^2 along the axis that it gives way most to, is 1 / w^2 of the
// part that swings there (Rayleigh's quotient of its static shape). Where a part is slower than `lowest` /
// sqrt(softness) hertz, its nodes get springs of their own (N/m in system.springs), by which it is not, up to a tenth;
// `notes` names joints whose tissue this held, and how slow it was. lowest: Hz, 0: nothing is held. softness: N. Throws
// Error(mismatch) where tets are too flat to compute with.
void hold_slow_parts(double lowest, const Eigen::VectorXd& softness, const Skeleton& skeleton, const TetMesh& mesh,
                     const JiggleAnatomy& anatomy, JiggleSystem& system, std::vector<std::string>& notes);

}  // namespace bodyopt
