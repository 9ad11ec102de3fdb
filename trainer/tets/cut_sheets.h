// Sheets cut off the surface that they stand on.
#pragma once

#include <vector>

#include "geometry/mesh.h"

namespace bodyopt {

// Which triangles are of sheets that share edges with a surface and bound no volume: fins, webs, frills. They end in
// open edges and meet the rest at edges of three triangles or more. The smallest is cut off first, until no edge that
// is left has more than two triangles, or what meets there has no open edge.
std::vector<bool> sheet_triangles(const Positions& vertices, const Triangles& triangles);

}  // namespace bodyopt
