// Tetrahedra of second order: with a node on the middle of every edge.
#pragma once

#include <Eigen/SparseCore>

#include "trainer/tets/cage.h"

namespace bodyopt::trainer {

// Every tet becomes one of second order, given as the eight linear ones that its ten nodes make. Tets 8 t + a, a =
// 0..3, have corner a of tet t as their own corner a. Their corner b is the middle of the edge from a to b. Between
// them lie tets 8 t + 4 .. 8 t + 7. The nodes of the surface come first, as in `mesh`: corners, then middles.
TetMesh second_order(const TetMesh& mesh);

// Makes the tets of a cage second-order, with all that it carries.
Cage second_order(Cage cage);

// N x C: takes values at the nodes of the linear tets that those of second order were made of to all their nodes. A
// middle's value is the mean of its edge's ends.
Eigen::SparseMatrix<double> from_corners(const TetMesh& second_order);

}  // namespace bodyopt::trainer
