// A limb whose tip hangs under a root, as feet do that inverse kinematics moves.
#pragma once

#include "assets/characters/character.h"

namespace bodyopt {

// Joints: the root, the limb's joint2 (its tip), joint0 and joint1, from which the tip's skin goes on.
Character detached_limb();

}  // namespace bodyopt
