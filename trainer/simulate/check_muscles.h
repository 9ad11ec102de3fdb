// Muscles that would have no effect, found before long work.
#pragma once

#include <string>
#include <vector>

#include "trainer/dataset/character.h"
#include "trainer/simulate/muscle_fibres.h"

namespace bodyopt {

// One sentence naming the muscles that fill no tet, being too thin for them; empty when all do. fibres: of
// label_muscles. Throws Error(mismatch) naming a muscle whose whole path lies outside the skin.
std::string check_muscles(const Character& character, const std::vector<Muscle>& muscles,
                          const std::vector<FibreTet>& fibres);

}  // namespace bodyopt
