// Which joints move skin, and which all of it.
#pragma once

#include <vector>

#include "assets/character.h"

namespace bodyopt {

// Of every joint, how many joints that skin follows, by more than a trace, are at or below it.
std::vector<int> joints_with_skin(const Character& character);

// Of every joint, whether all joints that skin follows are at or below it: it moves all of the skin and bends none of
// it, as a root does, wherever it stands.
std::vector<bool> joints_of_all_skin(const Character& character);

}  // namespace bodyopt
