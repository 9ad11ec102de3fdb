// Rigs of more joints, made of coarser ones.
#pragma once

#include "assets/character.h"

namespace bodyopt::bench {

// Every bone, from a joint to its first child, gets a joint in its middle, which takes of each vertex's weight more the
// nearer the vertex lies to the far end. The character moves as before while the new joints rest.
Character split_bones(Character character);

}  // namespace bodyopt::bench
