// Motion capture in BVH files carried to a skeleton.
#pragma once

#include <filesystem>

#include "assets/clip.h"

namespace bodyopt {

// Joints are matched as match_joints() says, the motion is carried over as Retarget says; at rest all rotations of a
// BVH are zero. The unit makes the offsets between matched joints as long, in total, as the skeleton's, unless the
// options state it.
Clip read_bvh_clip(const std::filesystem::path& path, const SkeletonChoice& choose, const ClipOptions& options);

// Writes the clip as a BVH of the skeleton's joints, in metres; blanks in names become underscores. Every joint is
// where the clip has it; scale is left out. Throws Error(file), also for a skeleton of several roots.
void write_bvh(const Clip& clip, const Skeleton& skeleton, const std::filesystem::path& path);

}  // namespace bodyopt
