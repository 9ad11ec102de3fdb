// Whether tetrahedra can carry finite elements, and how well shaped they are.
#pragma once

#include "geometry/tet_mesh.h"

namespace bodyopt {

// Mean-ratio qualities, 0 (flat) .. 1 (regular).
struct TetQuality {
  double worst = 0, first_percentile = 0, median = 0;
};

TetQuality tet_quality(const TetMesh& mesh);

// Throws Error(mismatch), naming the tet or node, where a node is not finite, a tet names a node that is not there, is
// inverted or has next to no volume, or a node belongs to no tet.
void require_sound(const TetMesh& mesh);

}  // namespace bodyopt
