// How poses turn a joint away from the bind pose.
#pragma once

#include <vector>

#include "runtime/basis/skeleton.h"

namespace bodyopt {

// Of every pose, about the world's axes with all parents at rest: as joint_turns().
std::vector<Quat> turns_from_bind(const Skeleton& skeleton, const std::vector<Pose>& poses, std::size_t joint);

// From a joint to the middle of the joints below, in the bind pose, metres; zero where there are none.
Vec3 length_of_bone(const Skeleton& skeleton, std::size_t joint);

}  // namespace bodyopt
