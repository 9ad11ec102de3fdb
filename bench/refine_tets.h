// Finer tetrahedra, made of coarse ones.
#pragma once

#include "trainer/tets/coarse_skin.h"

namespace bodyopt::bench {

// Every edge is halved, and every tet cut into eight of an eighth of its volume (Bey 1995). The first `surface` nodes
// of the mesh, and no others, are on its surface, and so are those of the result, whose skin they are.
FilledSkin refine_tets(const TetMesh& mesh, Eigen::Index surface);

}  // namespace bodyopt::bench
