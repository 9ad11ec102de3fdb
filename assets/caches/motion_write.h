// A clip as a file for other programs, of any format.
#pragma once

#include <filesystem>

#include "assets/clips/clip.h"

namespace bodyopt {

// The ending tells the format: .glb as write_clip() writes it, .bvh (bvh_clip.h; metres), or .usda. The last is a
// UsdSkel skeleton and its animation, in metres, with a time sample of each joint per frame, at its number. Throws
// Error(file).
void write_motion(const Clip& clip, const Skeleton& skeleton, double unit, const std::filesystem::path& path);

}  // namespace bodyopt
