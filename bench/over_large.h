// A basis that holds its training frames: what is lost on the way through components, tables and the deformer.
#pragma once

#include "runtime/basis/basis.h"
#include "trainer/train/data/samples.h"

namespace bodyopt::bench {

// Regions as train() makes them, with as many components as the frames have, every entry and that of its rounding, and
// narrow kernels at every frame which interpolate the coefficients. Frames of one pose and another shape cannot both be
// held. For some hundreds of frames.
Basis over_large_basis(const SampleSet& set);

// Largest distance of the deformer's skin from the training frames, metres.
double largest_distance(const Basis& basis, const SampleSet& set);

}  // namespace bodyopt::bench
