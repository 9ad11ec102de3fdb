// Finer skins, made of coarse ones.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "assets/characters/character.h"

namespace bodyopt::bench {

// A finer skin. The first vertices are the coarse ones (welded). Vertex #coarse + k is the middle of the two vertices
// parents[k], which come before it, and has the mean of their weights. Output vertices are the welded ones.
struct Subdivision {
  Character character;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> parents;
};

// The longest edge is halved, and the triangles beside it, until there are so many vertices.
Subdivision halve_longest_edges(const Character& coarse, std::size_t vertices);

// Every edge is halved, and every triangle cut into four.
Subdivision halve_all_edges(const Character& coarse);

// A shape of the coarse skin (V x 3, welded), with its middles.
Positions with_middles(const Positions& coarse, const Subdivision& subdivision);

}  // namespace bodyopt::bench
