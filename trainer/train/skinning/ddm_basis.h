// A basis of Direct Delta Mush and nothing else, which takes no shapes.
#pragma once

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

// `ordered`: a character in runtime order.
DdmBase make_ddm_base(const Character& ordered, double radius, const TrainOptions& options);

// DDM, no shapes: mesh and ddm tables, an empty residual.
Basis build_ddm_basis(const Character& character, const TrainOptions& options);

}  // namespace bodyopt
