// Coarse tetrahedra that carry a skin.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/nearest_skin.h"
#include "geometry/surface_distance.h"
#include "geometry/tet_mesh.h"
#include "runtime/core/error.h"
#include "trainer/tets/fillable_skin.h"
#include "trainer/tets/loose_pieces.h"
#include "trainer/tets/tets.h"

namespace bodyopt::trainer {

// A piece of what the skin encloses.
struct CageSample {
  EmbeddedPoint point;
  double volume;  // cubic metres
};

struct Cage {
  TetMesh mesh;
  std::vector<EmbeddedPoint> skin;   // V: where every vertex lies
  std::vector<CageSample> samples;   // what is tissue in the cage
  LoosePieces loose_pieces;          // what of a mended skin has no tets
  bool is_own_skin = false;          // its first nodes are vertices of the skin
  bool is_lattice = false;           // its tets reach beyond the skin and may overlap where parts are close
  std::optional<Error> why_lattice;  // what kept the skin from being filled
  std::string mending;               // what was done to fill it, as FillableSkin::mending
  std::vector<GluedVertex> glued;    // of make_cage: parts that it holds together and the joints would not
};

// A coarser skin filled with tets (skin_cage), of max_nodes nodes or fewer. Throws Error(mismatch) if more than one
// piece of the skin is filled (fillable_skin), or a tet has a mean-ratio quality below 0.05. Nor may one vertex lie
// outside its tet by four times its height, or over one in a hundred by more than that height.
Cage filled_cage(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
                 Eigen::Index max_nodes);

// Tets that fill the skin itself, mended where it must be (fillable_skin). size: largest edge wanted inside, metres; 0:
// three times the skin's mean edge. Throws as fillable_skin and tetrahedralise.
Cage own_cage(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights, double size);

// Nodes at most: of a coarser skin, or where none is so coarse, of a finer one; of the skin's own tets; of a lattice.
struct CageLimits {
  Eigen::Index nodes, finer_nodes, own_nodes, lattice_nodes;
};
// Tries the skin's own tets (own_cage) if these have no more nodes than a coarser skin's, then coarser skins
// (filled_cage), then the own tets anyway. If all fail it makes a lattice (lattice_cage), whose why_lattice then is the
// last error. Throws as lattice_cage.
Cage make_cage(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
               const CageLimits& limits);

// The skin is remeshed with longer edges, which stay short where a part is thin, and filled (tetrahedralise). The cage
// is the finest found of at most `max_nodes` nodes, and not finer than the skin itself. Its surface cuts corners:
// vertices lie outside. The tet behind the nearest triangle that faces as the skin does there carries them, so that
// fingers stay apart. A function of its arguments alone.
//
// Throws Error(mismatch) when the skin is not closed or no coarser skin can be filled with tets of a mean-ratio quality
// of 0.05 at least.
Cage skin_cage(const Positions& vertices, const Triangles& triangles, Eigen::Index max_nodes);

// The cage that the tets of a coarser skin make: where they carry every vertex of the fine one, and their samples.
Cage cage_in(const FineSkin& fine, const FilledSkin& filled);

// Skin that moves of the joints part, however near to each other it lies at rest.

constexpr double kSharedByOne = 0.6;  // of the weights of two points in common: less is skin of other joints
constexpr double kDetour = 3;         // along the skin, times the way through the air: further is not beside it

// Whether two points of a skin (rest, metres) follow other joints and are far from each other along it. So are lips,
// thighs and fingers that touch, but not points about a joint. Nor are points with flesh in between, as in and out of a
// cheek: one is behind the other by more than `overlap` metres. The arrays must outlive this.
class ApartSkin {
 public:
  ApartSkin(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights);
  bool operator()(const SkinPoint& a, const SkinPoint& b, double overlap) const;

 private:
  double depth(const SkinPoint& point, const SkinPoint& other) const;

  const Positions& vertices_;
  const SkinWeights& weights_;
  double outwards_;  // 1 where triangles wind outwards, else -1
  SurfaceDistance distance_;
};

}  // namespace bodyopt::trainer
