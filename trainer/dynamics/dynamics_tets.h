// The tetrahedra of diffuse and jiggle: they fill the skin, and their surface nodes lie on it.
#pragma once

#include <vector>

#include "geometry/nearest_skin.h"
#include "geometry/tet_mesh.h"
#include "trainer/tets/cage.h"

namespace bodyopt {
struct TetTable;
}

namespace bodyopt::trainer {

// Whether tetrahedra can carry finite elements, and how well shaped they are.

// Mean-ratio qualities, 0 (flat) .. 1 (regular).
struct TetQuality {
  double worst = 0, first_percentile = 0, median = 0;
};

TetQuality tet_quality(const TetMesh& mesh);

// Throws Error(mismatch), naming the tet or node, where a node is not finite or belongs to no tet. It does so, too, for
// a tet that names a missing node, is inverted or has next to no volume.
void require_sound(const TetMesh& mesh);

// Tetrahedra that stay right side out where diffuse carries them.

// Tets that diffuse turns inside out, summed over the poses that were looked at.
struct Unfolding {
  Eigen::Index poses = 0, before = 0, after = 0;
};

struct DynamicsTets {
  Cage cage;                       // its first B nodes lie on the skin
  std::vector<SkinPoint> surface;  // B: where
  Unfolding unfolding;
};

// Fills what of the skin can be filled (fillable_skin) with `most_tets` or fewer. The skin is taken as it is where that
// comes out well, otherwise remeshed with longer edges (fill_coarser), never finer. Then unfolds the tets in the skin's
// poses (V x 3 each). Nodes are rounded to single precision. Throws Error(mismatch) naming the cause where no filling
// is found: open sheets, parts that cannot be distinguished.
DynamicsTets make_dynamics_tets(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
                                Eigen::Index most_tets, const std::vector<Positions>& poses = {});

// V each: how much of its tet's displacement every skin vertex takes, and the metres that it never reaches.
TetTable make_tet_table(const DynamicsTets& tets, const std::vector<double>& amounts,
                        const std::vector<double>& limits);

}  // namespace bodyopt::trainer
