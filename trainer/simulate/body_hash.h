// Which inputs a simulated shape came from.
#pragma once

#include "trainer/dataset/muscles.h"
#include "trainer/simulate/tets.h"

namespace bodyopt {

// xxh3 of tets, skeleton, skin weights, muscles, material constants and the version of the solver.
std::uint64_t body_hash(const Character& character, const std::vector<Muscle>& muscles, const TetMesh& mesh);

// xxh3 of a pose on top of a body's hash.
std::uint64_t pose_hash(std::uint64_t body, const Pose& pose);

}  // namespace bodyopt
