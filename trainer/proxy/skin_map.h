// Where a proxy's skin carries the full one.
#pragma once

#include <span>
#include <vector>

#include "assets/character.h"
#include "runtime/basis/levels.h"

namespace bodyopt {

// Puts every vertex of the full skin on the nearest triangle of the proxy's rest skin that faces as the full skin does
// there (so that fingers stay apart), or on the nearest of all, and keeps its offset from there, in steps of 1/32767 of
// the largest. -> one for every output vertex of `full`. `mesh`: of the proxy's basis.
CarriedSkin map_skin(const Character& full, const MeshTable& mesh);

// A skin as an Evaluation has it: O x 3 in output order. `vertices`: V x 3 in runtime order of the mesh.
struct ShownSkin {
  std::vector<float> positions, normals;
};
ShownSkin show_skin(const MeshTable& mesh, std::span<const float> vertices);

// Distances of the full rest skin's vertices from the proxy's, mm.
struct SkinDistance {
  double rms = 0, max = 0;
};
SkinDistance skin_distance(const Character& full, const Character& proxy);

}  // namespace bodyopt
