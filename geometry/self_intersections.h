// Finds where a surface passes through itself.
#pragma once

#include <vector>

#include "geometry/mesh.h"

namespace bodyopt {

struct TrianglePair {
  Eigen::Index first, second;  // first < second
  bool operator==(const TrianglePair&) const = default;
};

// All pairs of triangles of which an edge of one passes through the other, ascending. If triangles have one common
// corner, the edges opposite to it count; triangles with a common edge, and triangles in one plane, are left out.
// Vertices must be finite.
[[nodiscard]] std::vector<TrianglePair> self_intersections(const Positions& vertices, const Triangles& triangles);
// The corners of such triangles, ascending.
std::vector<std::uint32_t> corners_of(const std::vector<TrianglePair>& pairs, const Triangles& triangles);

struct BuriedVertex {
  std::uint32_t vertex;
  double depth;  // metres, to the nearest skin there that faces it
};

// The vertices outside of which, by a micron, the body goes on: the winding number there is 1 or more. Ascending. They
// are looked for from where triangles pass through each other. The skin winds outwards; where it is open, what lies
// behind an opening may be missed.
[[nodiscard]] std::vector<BuriedVertex> skin_in_skin(const Positions& vertices, const Triangles& triangles);

}  // namespace bodyopt
