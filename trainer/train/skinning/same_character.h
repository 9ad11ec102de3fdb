// Is a basis of this character?
#pragma once

#include "runtime/basis/basis.h"

namespace bodyopt {

// Throws Error(mismatch) where the basis has other vertices or triangles, another skeleton, or another rest skin than
// `mesh` (as make_mesh_table) and `skeleton`.
void require_same_character(const MeshTable& mesh, const Skeleton& skeleton, const Basis& basis);

}  // namespace bodyopt
