// A lattice of tetrahedra around any skin: open, self-intersecting, non-manifold, in pieces.
#pragma once

#include "trainer/tets/cage.h"

namespace bodyopt::trainer {

// The skin is filled with small cubes (voxelise) that lie in a lattice of cubic cells, eight along an edge. Each part
// of a cell that the filled cubes connect becomes a cell of its own (virtual nodes: Molino, Bao, Fedkiw 2004). Two legs
// or an arm and a trunk in one cell move apart then. Cells share corners where filled cubes touch through their common
// face. Touching skin that the joints part (ApartSkin), as lips and thighs, does not connect cubes, where the body
// holds together without. Separate pieces of skin in one cell are joined. A cell is five tets, those without tissue
// left out: mean-ratio quality 0.84 or more. A function of its arguments alone.
//
// Throws Error(mismatch) without triangles, with all vertices in one place or one not finite or without weights, or
// where a triangle names a missing one.
// `cell`: edge of a cell, metres. Throws Error(usage) if it is so small that memory would run out.
Cage lattice_cage_of_size(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
                          double cell);
// The finest found of at most `max_nodes` nodes; 100 or more can always be kept to.
Cage lattice_cage(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
                  Eigen::Index max_nodes);

}  // namespace bodyopt::trainer
