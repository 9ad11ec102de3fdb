// Rotations between coordinate axes, to find which way is up.
#pragma once

#include <vector>

#include "geometry/mesh.h"
#include "runtime/basis/skeleton.h"

namespace bodyopt {

// All 24: none first, then between Z-up and Y-up, then the rest, so that the plainest wins a tie.
std::vector<Quat> axis_turns();

// Meshes may lie in their own space, stood upright by the nodes above the joints. Returns the one of axis_turns() that
// turns the first joint, within 15 degrees, from the bind pose to where the file's nodes have it. It is none where that
// leaves upright what is upright.
Quat turn_upright(const Skeleton& skeleton);

// A skin at rest (V x 3) so turned, for pictures.
Positions upright_skin(const Skeleton& skeleton, const Positions& vertices);

}  // namespace bodyopt
