// Tetrahedra that fill a body.
#pragma once

#include "geometry/tet_mesh.h"

namespace bodyopt {

// Netgen's nglib on the welded skin (which must be closed and free of self-intersections). The first V nodes are the
// skin's vertices, unmoved. `size` is the largest edge wanted inside, metres. Throws Error(mismatch) naming the cause
// when the skin cannot be filled.
TetMesh tetrahedralise(const Positions& vertices, const Triangles& triangles, double size);

}  // namespace bodyopt
