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
  bool is_lattice = false;           // its tets reach beyond the skin and may overlap where parts are close
  std::optional<Error> why_lattice;  // what kept the skin from being filled
  std::string mending;               // what was done to fill it, as FillableSkin::mending
  std::vector<GluedVertex> glued;    // of make_cage: parts that it holds together and the joints would not
};

// A coarser skin filled with tets (skin_cage) where that comes out well: skin of which one piece is filled
// (fillable_skin) and carries the others, no tet of a mean-ratio quality below 0.05, hardly a vertex (1 %) further
// outside its tet than that is high, none more than four times as far. Otherwise a lattice (lattice_cage). Of max_nodes
// nodes or fewer. Throws as lattice_cage.
Cage make_cage(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
               Eigen::Index max_nodes);
// The first kind alone; `glued` stays empty. Throws Error(mismatch) where it does not come out well.
Cage filled_cage(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
                 Eigen::Index max_nodes);

}  // namespace bodyopt
