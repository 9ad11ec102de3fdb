// A hash of the inputs that a simulated shape came from.
#pragma once

#include "assets/characters/character.h"
#include "assets/characters/muscles.h"
#include "geometry/tet_mesh.h"
#include "trainer/simulate/materials.h"

namespace bodyopt::trainer {

// xxh3 of tets, skin, skeleton, skin weights, muscles, materials, AnatomyField::hash() and the version of the solver.
std::uint64_t body_hash(const Character& character, const std::vector<Muscle>& muscles, const Materials& materials,
                        const TetMesh& mesh, std::uint64_t anatomy);

// xxh3 of a pose and of how far each muscle is flexed, on top of a body's hash.
std::uint64_t pose_hash(std::uint64_t body, const Pose& pose, const std::vector<double>& flex);

}  // namespace bodyopt::trainer
