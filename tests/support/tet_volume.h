// The volume that tets fill.
#pragma once

#include "geometry/tet_mesh.h"

namespace bodyopt {

// Cubic metres.
double volume(const TetMesh& mesh);

}  // namespace bodyopt
