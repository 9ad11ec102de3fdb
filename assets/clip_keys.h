// Where the animator's keys are.
#pragma once

#include <string>
#include <vector>

#include "assets/clip.h"

namespace bodyopt {

// The frames of read_clip()'s clip that are nearest to a key of any channel, rising. None of a BVH, which samples its
// motion. Throws Error(file).
std::vector<int> clip_keys(const std::string& source, const ClipOptions& options);

}  // namespace bodyopt
