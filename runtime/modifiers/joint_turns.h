// How far the joints of a character are turned.
#pragma once

#include <vector>

#include "runtime/basis/skeleton.h"

namespace bodyopt {

// Rotations of all joints, world, of local ones.
std::vector<Quat> world_rotations(const Skeleton& skeleton, const std::vector<Quat>& local);
std::vector<Quat> bind_world_rotations(const Skeleton& skeleton);

// Of a pose, per joint: its turn away from the bind pose, as an axis in rest space times an angle, radians.
std::vector<Vec3> rest_turns(const Skeleton& skeleton, const Pose& pose);

// Per joint: its turn, that of its parent, unless that is a root, and that of the child that turns most, together. Skin
// folds of what neighbours do between them: four joints of a spine, say, each bent a little.
std::vector<Vec3> fold_bends(const Skeleton& skeleton, const Pose& pose);

}  // namespace bodyopt
