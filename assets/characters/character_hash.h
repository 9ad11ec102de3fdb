// A hash of a character, to know it again.
#pragma once

#include "assets/characters/character.h"
#include "base/content_hash.h"

namespace bodyopt {

// Its welded skin, weights and skeleton: all that a shape in a pose depends on.
void add(ContentHash& hash, const Character& character);

}  // namespace bodyopt
