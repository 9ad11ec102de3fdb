// The motion of a skeleton as a glTF animation.
#pragma once

#include "assets/clips/clip.h"
#include "assets/gltf/gltf_write.h"

namespace bodyopt {

// Unit length, and each key the nearer of q and -q to the one before: viewers that interpolate components need it.
Clip with_continuous_rotations(Clip clip);

// Has a channel for each property of a joint that leaves its default pose, and one at least. The keys are the clip's
// frames, the first at 0 seconds. Joint j is node j.
Json motion_animation(const Clip& clip, const Skeleton& skeleton, GlbWriter& glb);

}  // namespace bodyopt
