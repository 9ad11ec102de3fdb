// Which joints' turns a character's skin is learned by.
#pragma once

#include <vector>

#include "assets/character.h"

namespace bodyopt {

// As joint_features_of() its skeleton, but that joints which all of the skin hangs under count as not turning: they
// bend none of it, and a body that leans must not look like one in a pose that training lacks. Empty where there are
// none but roots, as in Skeleton.
std::vector<JointFeatures> learned_features(const Character& character);

}  // namespace bodyopt
