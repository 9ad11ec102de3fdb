// Samples whose shapes are those of a trained basis: what a proxy learns from where there is no dataset.
#pragma once

#include <span>

#include "runtime/basis/basis.h"
#include "trainer/train/data/samples.h"

namespace bodyopt {

// One sample for every pose, named by `frames`, its shape by the teacher on the CPU; shapes stay in memory. Every fifth
// block of ten frames is held out. The poses' controls are the teacher's. Throws Error(mismatch) where the teacher is
// not of this character, or a pose does not fit.
SampleSet taught_samples(const Character& character, const std::vector<Muscle>& muscles, const Basis& teacher,
                         std::span<const Pose> poses, std::span<const int> frames);

}  // namespace bodyopt
