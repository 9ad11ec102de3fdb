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

BadEdges find_bad_edges(const Triangles& triangles);

}  // namespace bodyopt
