// A coarser skin filled with tetrahedra.
#pragma once

#include "trainer/tets/cage.h"
#include "trainer/tets/coarse_skin.h"

namespace bodyopt {

// The skin is remeshed with longer edges, which stay short where a part is thin, and filled (tetrahedralise). The
// finest found of at most `max_nodes` nodes, and not finer than the skin itself. Its surface cuts corners: a vertex
// that lies outside is carried by the tet behind the nearest triangle that faces as the skin does there, so that
// fingers stay apart. A function of its arguments alone.
//
// Throws Error(mismatch) when the skin is not closed or no coarser skin can be filled with tets of a mean-ratio quality
// of 0.05 at least.
Cage skin_cage(const Positions& vertices, const Triangles& triangles, Eigen::Index max_nodes);

// The cage that the tets of a coarser skin make: where they carry every vertex of the fine one, and their samples.
Cage cage_in(const FineSkin& fine, const FilledSkin& filled);

}  // namespace bodyopt
