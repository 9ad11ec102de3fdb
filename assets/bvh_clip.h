// Motion capture in BVH files carried to a skeleton.
#pragma once

#include <filesystem>

#include "assets/clip.h"

namespace bodyopt {

// Joints are matched as match_joints() says, the motion is carried over as Retarget says; at rest all rotations of a
// BVH are zero. The unit makes the offsets between matched joints as long, in total, as the skeleton's, unless the
// options state it.
Clip read_bvh_clip(const std::filesystem::path& path, const Skeleton& skeleton, const ClipOptions& options);

}  // namespace bodyopt
