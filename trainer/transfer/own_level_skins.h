// A target's own skin as levels of detail, where a source's do not lie on it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "assets/character.h"

namespace bodyopt {

// Of a level of detail.
struct TargetSkin {
  double error;  // asked of it, millimetres
  Character skin;
};

// The skin simplified for the default errors, as far as they make levels, `most` at most, by its rest shape and by
// linear blending of all joints turned 40 degrees about each of their axes, either way: no motion of it is known, and a
// skin simplified at rest alone keeps no vertices where limbs bend. `notes`, errors: as level_skins().
std::vector<TargetSkin> own_level_skins(const Character& character, std::size_t most, std::vector<std::string>& notes);

}  // namespace bodyopt
