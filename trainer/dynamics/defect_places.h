// Where a skin that cannot be filled with tetrahedra is amiss.
#pragma once

#include <string>

#include "assets/character.h"

namespace bodyopt {

// "; the skin is open at 'Head' (0.012 1.633 0.101 m)": where it is open, fused, turned or passes through itself, each
// by the joints that move it there and a vertex (rest space) of theirs. Empty where it is nothing of this.
std::string defect_places(const Character& character);

}  // namespace bodyopt
