// Where a surface passes through itself.
#pragma once

#include <vector>

#include "geometry/mesh.h"

namespace bodyopt {

struct TrianglePair {
  Eigen::Index first, second;  // first < second
  bool operator==(const TrianglePair&) const = default;
};

// All pairs of triangles of which an edge of one passes through the other, ascending. Of triangles with one common
// corner the edges opposite to it count; triangles with a common edge, and triangles in one plane, are left out.
// Vertices must be finite.
[[nodiscard]] std::vector<TrianglePair> self_intersections(const Positions& vertices, const Triangles& triangles);
// The corners of such triangles, ascending.
std::vector<std::uint32_t> corners_of(const std::vector<TrianglePair>& pairs, const Triangles& triangles);

}  // namespace bodyopt
