// What a proxy learns from: the data of the full skin at the vertices that stay, or, where there is no dataset, shapes
// by a trained basis.
#pragma once

#include <span>

#include "runtime/basis/basis.h"
#include "trainer/proxy/simplify_skin.h"
#include "trainer/train/data/samples.h"

namespace bodyopt {

// The character with the simplified skin: names, joints and, of every vertex that stays, place and weights are the
// same. Its output vertices are its welded ones.
Character proxy_character(const Character& character, const SimplifiedSkin& skin);

// The same frames, muscles, controls and painted regions. Shapes stay where they are, and only rows of them are read.
// A painted region that keeps no vertex is left out, with a note.
SampleSet proxy_samples(const SampleSet& set, const SimplifiedSkin& skin);

// One sample for every pose, named by `frames`, its shape by the teacher on the CPU; shapes stay in memory. Every fifth
// block of ten frames is held out. The poses' controls are the teacher's. Throws Error(mismatch) where the teacher is
// not of this character, or a pose does not fit.
SampleSet taught_samples(const Character& character, const std::vector<Muscle>& muscles, const Basis& teacher,
                         std::span<const Pose> poses, std::span<const int> frames);

}  // namespace bodyopt
