// Diffuse: from the skin's nodes to those inside.
#pragma once

#include "geometry/tet_mesh.h"

namespace bodyopt {

struct DiffuseTable;

// The first `surface_count` nodes of the mesh are given, the others follow: the finite-element Laplacian of the rest
// tets, split, and its inner part inverted. Throws Error(mismatch) where that is singular.
DiffuseTable make_diffuse_table(const TetMesh& mesh, Eigen::Index surface_count);

// The same in double precision, for columns of values: surface_count x any -> N x the same.
Eigen::MatrixXd diffuse(const TetMesh& mesh, const Eigen::MatrixXd& on_surface);

}  // namespace bodyopt
