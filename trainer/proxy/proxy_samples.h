// What a proxy learns from: the data of the full skin at the vertices that stay.
#pragma once

#include "trainer/proxy/simplify_skin.h"
#include "trainer/train/data/samples.h"

namespace bodyopt {

// The character with the simplified skin: names, joints and, of every vertex that stays, place and weights are the
// same. Its output vertices are its welded ones.
Character proxy_character(const Character& character, const SimplifiedSkin& skin);

// The same frames, muscles, controls and painted regions. Shapes stay where they are, and only rows of them are read.
// A painted region that keeps no vertex is left out, with a note.
SampleSet proxy_samples(const SampleSet& set, const SimplifiedSkin& skin);

}  // namespace bodyopt
