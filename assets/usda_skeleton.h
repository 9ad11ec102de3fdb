// A skeleton and its motion as USD text: a Skeleton with its SkelAnimation below a SkelRoot, metres, Y up.
#pragma once

#include <filesystem>

#include "assets/clip.h"

namespace bodyopt {

// The clip has frames, each with the joints of the skeleton. Throws Error(file).
void write_usd_skeleton(const Clip& clip, const Skeleton& skeleton, const std::filesystem::path& path);

}  // namespace bodyopt
