// A skeleton and its motion as USD text: a Skeleton with its SkelAnimation below a SkelRoot, metres, Y up.
#pragma once

#include <filesystem>
#include <string>

#include "assets/clips/clip.h"

namespace bodyopt {

// Returns the skeleton and its motion, for a SkelRoot of that name; the SkelAnimation is still open. Throws Error(file)
// for numbers that are not finite; messages call the file `path`.
std::string usd_skeleton(const Clip& clip, const Skeleton& skeleton, const std::string& root,
                         const std::filesystem::path& path);

// The clip has frames, each with the joints of the skeleton. Throws Error(file).
void write_usd_skeleton(const Clip& clip, const Skeleton& skeleton, const std::filesystem::path& path);

}  // namespace bodyopt
