// Muscles that would have no effect, or hardly any, found before long work.
#pragma once

#include <string>
#include <vector>

#include "assets/characters/character.h"
#include "trainer/simulate/quasi_static.h"

namespace bodyopt::trainer {

// One sentence naming the muscles that have no tissue, thinner than the anatomy tells apart; empty when there are none.
// Throws Error(mismatch) naming a muscle whose whole path lies outside the skin.
std::string check_muscles(const Character& character, const std::vector<Muscle>& muscles, const QuasiStaticBody& body);

}  // namespace bodyopt::trainer
