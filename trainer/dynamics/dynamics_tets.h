// The tetrahedra of diffuse and jiggle: they fill the skin, and their surface nodes lie on it.
#pragma once

#include <vector>

#include "geometry/nearest_skin.h"
#include "trainer/dynamics/unfold_tets.h"
#include "trainer/tets/cage.h"

namespace bodyopt {

struct TetTable;

struct DynamicsTets {
  Cage cage;                       // its first B nodes lie on the skin
  std::vector<SkinPoint> surface;  // B: where
  Unfolding unfolding;
};

// What of the skin can be filled (fillable_skin), filled with `most_tets` or fewer: as it is where that takes no more
// and comes out well, otherwise remeshed with longer edges (fill_coarser), never finer than it is. Then unfolded in the
// poses of the skin (V x 3 each). Nodes are rounded to single precision. Throws Error(mismatch) naming the cause where
// no filling is found: open sheets, parts that cannot be told apart.
DynamicsTets make_dynamics_tets(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
                                Eigen::Index most_tets, const std::vector<Positions>& poses = {});

// V each: how much of its tet's displacement every skin vertex takes, and the metres that it never reaches.
TetTable make_tet_table(const DynamicsTets& tets, const std::vector<double>& amounts,
                        const std::vector<double>& limits);

}  // namespace bodyopt
