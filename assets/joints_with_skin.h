// Which joints move skin, and which all of it.
#pragma once

#include <cstdint>
#include <vector>

#include "assets/character.h"

namespace bodyopt {

// Of every joint, how many joints that skin follows, by more than a trace, are at or below it.
std::vector<int> joints_with_skin(const Character& character);

// Of every joint, whether all joints that skin follows are at or below it: it moves all of the skin and bends none of
// it, as a root does, wherever it stands.
std::vector<bool> joints_of_all_skin(const Character& character);

// The joints that a pose is told by: all but roots and those of all skin, ascending.
std::vector<std::uint32_t> joints_that_bend(const Character& character);

}  // namespace bodyopt
