// Tetrahedra of second order: with a node on the middle of every edge.
#pragma once

#include <Eigen/SparseCore>

#include "trainer/tets/cage.h"

namespace bodyopt {

// Every tet becomes one of second order, told as the eight linear ones that its ten nodes make: tets 8 t + a, a = 0..3,
// have corner a of tet t as their own corner a, and the middle of the edge from a to b as their corner b; 8 t + 4 .. 8
// t + 7 are what is between them. The nodes of the surface come first, as in `mesh`: corners, then middles.
TetMesh second_order(const TetMesh& mesh);

// The same of a cage, with all that it carries.
Cage second_order(Cage cage);

// N x C: from values at the nodes of the linear tets that those of second order were made of to all their nodes: a
// middle's is the mean of its edge's ends.
Eigen::SparseMatrix<double> from_corners(const TetMesh& second_order);

}  // namespace bodyopt
