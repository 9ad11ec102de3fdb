// Muscles that would have no effect, found before long work.
#pragma once

#include <string>
#include <vector>

#include "assets/character.h"
#include "trainer/simulate/quasi_static.h"

namespace bodyopt {

// One sentence naming the muscles that fill no tet of the body, because they are too thin for one or others have
// them; empty when all muscles fill some. Throws Error(mismatch) naming a muscle whose whole path lies outside the
// skin.
std::string check_muscles(const Character& character, const std::vector<Muscle>& muscles, const QuasiStaticBody& body);

}  // namespace bodyopt
