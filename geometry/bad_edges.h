// Edges that keep a skin from being closed.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "geometry/mesh.h"

namespace bodyopt {

using VertexPair = std::pair<std::uint32_t, std::uint32_t>;  // ascending

// Each list ascending.
struct BadEdges {
  std::vector<VertexPair> open;     // of a single triangle
  std::vector<VertexPair> shared;   // of more than two
  std::vector<VertexPair> flipped;  // of two that run through it in the same direction
};

[[nodiscard]] BadEdges find_bad_edges(const Triangles& triangles);

// Without those that are there twice, whichever way they wind: their edges are neither open nor turned.
[[nodiscard]] Triangles each_once(const Triangles& triangles);

}  // namespace bodyopt
