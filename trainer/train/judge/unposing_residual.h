// What un-posing alone leaves to learn.
#pragma once

#include "runtime/basis/basis.h"
#include "trainer/train/data/samples.h"

namespace bodyopt {

// RMS (mm) of what is left to learn after un-posing each shape by DDM, and by linear blend skinning, the mean over
// frames taken out of neither: over vertices and at most 200 training frames, spread evenly.
struct UnposingResidual {
  double lbs = 0, ddm = 0;
};
UnposingResidual unposing_residual(const SampleSet& set, const Basis& basis);

}  // namespace bodyopt
