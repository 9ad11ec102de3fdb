// A basis of Direct Delta Mush and nothing else, which takes no shapes.
#pragma once

#include <string>
#include <vector>

#include "assets/character.h"
#include "runtime/basis/basis.h"
#include "trainer/train/options.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt {

// Direct Delta Mush and nothing else, and the moments it is made of.
struct DdmBase {
  Basis basis;
  std::vector<VertexMoments> moments;
  double radius = 0;  // sigma, metres
};

// What a basis' metadata say of how it was made: JSON. `updated`: it was brought on from an earlier training; one from
// the start, of the same data and options, is another.
std::string provenance_text(const Character& character, double radius, const TrainOptions& options, bool updated);

// `ordered`: a character in runtime order.
DdmBase make_ddm_base(const Character& ordered, double radius, const TrainOptions& options);

// DDM, no shapes: mesh and ddm tables, an empty residual.
Basis build_ddm_basis(const Character& character, const TrainOptions& options);

}  // namespace bodyopt
