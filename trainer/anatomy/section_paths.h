// Where the bellies of muscles lie in the sections of a limb: the paths of models are lines of action, not middles.
#pragma once

#include <vector>

#include "trainer/anatomy/lean_samples.h"
#include "trainer/anatomy/muscle_paths.h"

namespace bodyopt {

// Moves the middles of paths to where rigs/human/muscle_sections.json has them, where a body has the joints and
// landmarks for it; then those parts of bellies that do not lie in lean tissue to the nearest that do.
void guide_paths(const HalfBody& body, const LeanSamples& lean, std::vector<HalfMuscle>& muscles);

}  // namespace bodyopt
