// Coarse tetrahedra that carry a skin.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/embedding.h"
#include "runtime/core/error.h"
#include "trainer/tets/fillable_skin.h"
#include "trainer/tets/own_joints.h"
#include "trainer/tets/riders.h"

namespace bodyopt {

// A piece of what the skin encloses.
struct CageSample {
  EmbeddedPoint point;
  double volume;  // cubic metres
};

struct Cage {
  TetMesh mesh;
  std::vector<EmbeddedPoint> skin;   // V: where every vertex lies
  std::vector<CageSample> samples;   // what is tissue in the cage
  Riders riders;                     // what of a mended skin has no tets
  bool is_own_skin = false;          // its first nodes are vertices of the skin
  bool is_lattice = false;           // its tets reach beyond the skin and may overlap where parts are close
  std::optional<Error> why_lattice;  // what kept the skin from being filled
  std::string mending;               // what was done to fill it, as FillableSkin::mending
  std::vector<GluedVertex> glued;    // of make_cage: parts that it holds together and the joints would not
};

// A coarser skin filled with tets (skin_cage), of max_nodes nodes or fewer. Throws Error(mismatch) where that does not
// come out well: of the skin more than one piece is filled (fillable_skin), a tet has a mean-ratio quality below 0.05,
// more than a vertex in a hundred lies further outside its tet than that is high, or one four times as far.
Cage filled_cage(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
                 Eigen::Index max_nodes);

// Tets that fill the skin itself, mended where it must be (fillable_skin). size: largest edge wanted inside, metres; 0:
// three times the skin's mean edge. Throws as fillable_skin and tetrahedralise.
Cage own_cage(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights, double size);

// Nodes at most: of a coarser skin, or where none comes out so coarse, of a finer one; of the skin's own tets; of a
// lattice.
struct CageLimits {
  Eigen::Index nodes, finer_nodes, own_nodes, lattice_nodes;
};
// The first that comes out of the skin's own tets (own_cage) where these have no more nodes than a coarser skin's,
// coarser skins (filled_cage), the skin's own tets after all, and a lattice (lattice_cage), whose why_lattice then says
// why those before it did not. Throws as lattice_cage.
Cage make_cage(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
               const CageLimits& limits);

}  // namespace bodyopt
