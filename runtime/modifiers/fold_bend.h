// How far a character is bent about a joint.
#pragma once

#include "runtime/basis/skeleton.h"

namespace bodyopt {

// Radians: the turns away from the bind pose of the joint, of its parent and of that child that turns most, together.
// Skin folds of what neighbours do between them: four joints of a spine, say, each bent a little.
double fold_bend(const Skeleton& skeleton, const Pose& pose, std::uint32_t joint);

}  // namespace bodyopt
