// The skin in runtime order.
#pragma once

#include <cstdint>
#include <vector>

#include "assets/character.h"
#include "runtime/basis/basis.h"

namespace bodyopt {

// Welded vertex of each runtime vertex: the Morton order of the rest positions, ties in welded order.
std::vector<std::uint32_t> morton_order(const Positions& vertices);

// Rows of `welded` (V x 3) in runtime order.
Positions in_order(const Positions& welded, const std::vector<std::uint32_t>& order);

// The character with its welded vertices renumbered to runtime order; output order stays.
Character in_order(const Character& character, const std::vector<std::uint32_t>& order);

// `character` in runtime order.
MeshTable make_mesh_table(const Character& character);

// Throws Error(mismatch) where the basis has other vertices or triangles, another skeleton, or another rest skin than
// `mesh` (as make_mesh_table) and `skeleton`.
void require_same_character(const MeshTable& mesh, const Skeleton& skeleton, const Basis& basis);

}  // namespace bodyopt
