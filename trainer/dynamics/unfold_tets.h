// Tetrahedra that stay right side out where diffuse carries them.
#pragma once

#include <vector>

#include "geometry/nearest_skin.h"
#include "geometry/tet_mesh.h"

namespace bodyopt {

// Tets that diffuse turns inside out, summed over the poses that were looked at.
struct Unfolding {
  Eigen::Index poses = 0, before = 0, after = 0;
};

// Harmonic interpolation is not injective: behind a fold of the skin it may turn tets inside out. Moves their nodes at
// rest, one after the other, to where the tets around them are best shaped in the poses (optimisation-based smoothing,
// Freitag and Ollivier-Gooch 1997): nodes inside freely, the first `surface` nodes, which lie on the skin, along it
// where it `may_slide`. No tet gets flat at rest. Ends when no tet is inside out or after a few rounds, with the best
// found.
// skin: of the rest vertices; poses: V x 3 each, where these are. A function of its arguments alone.
Unfolding unfold_tets(const NearestSkin& skin, const std::vector<Positions>& poses, Eigen::Index surface,
                      bool may_slide, TetMesh& mesh);

}  // namespace bodyopt
