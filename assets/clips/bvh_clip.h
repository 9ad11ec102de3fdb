// Motion capture in BVH files, transferred to a skeleton.
#pragma once

#include <filesystem>

#include "assets/clips/bvh.h"
#include "assets/clips/clip.h"

namespace bodyopt {

// Joints are matched as match_joints() says, the motion is transferred as Retarget says; at rest all rotations of a
// BVH are zero. The unit makes the offsets between matched joints as long, in total, as the skeleton's, unless the
// options state it.
Clip read_bvh_clip(const std::filesystem::path& path, const SkeletonChoice& choose, const ClipOptions& options);
// Reads the clip from a parsed BVH; the clip and errors are called by `path`.
Clip carry_bvh(const Bvh& bvh, const std::filesystem::path& path, const SkeletonChoice& choose,
               const ClipOptions& options);

// Writes the clip as a BVH of the skeleton's joints, in metres; blanks in names become underscores. With all rotations
// zero the character stands as it was bound, upright (turn_upright): all joints have the world's axes then. The file,
// read for this skeleton again, has every joint where the clip has it. Otherwise (the clip scales joints, or names do
// not tell them apart) nothing is written. Throws Error(file), also for a skeleton of several roots.
void write_bvh(const Clip& clip, const Skeleton& skeleton, const std::filesystem::path& path);

}  // namespace bodyopt
