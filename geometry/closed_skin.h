// Whether a skin encloses a volume.
#pragma once

#include "geometry/mesh.h"

namespace bodyopt {

// Passes when every edge joins exactly two triangles that run through it in opposite directions and every vertex
// belongs to a triangle. Otherwise throws Error(mismatch) naming and counting the defect.
void require_closed(const Positions& vertices, const Triangles& triangles);

// Volume enclosed by a closed skin, cubic metres; negative when its triangles wind inwards.
[[nodiscard]] double enclosed_volume(const Positions& vertices, const Triangles& triangles);

// Of the edges of all triangles, metres; 0 without triangles.
double mean_edge(const Positions& vertices, const Triangles& triangles);

}  // namespace bodyopt
