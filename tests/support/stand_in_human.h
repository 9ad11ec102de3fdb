// A human of our own: what tests of a body on two legs run on, be the shared data there or not.
#pragma once

#include <string>
#include <vector>

#include "assets/characters/character.h"

namespace bodyopt {

// Closed, of one piece, symmetric, 1.7 m tall; every vertex hangs on the nearest bone. Joints by the names that the
// human rig has (rigs/human). The bones of the right side do not mirror the left's: each is turned about by some angle
// of its own, as in files of other programs.
Character stand_in_human();

// The stand-in, and the human of the shared data where it is there.
std::vector<Character> humans(const std::string& file);

}  // namespace bodyopt
