// How the samples of a truth lie on the frames of a clip.
#pragma once

#include <string>

#include "trainer/dataset/clip.h"
#include "trainer/dataset/pc2.h"

namespace bodyopt {

// One sentence or two for the user, where they are not one for one; otherwise empty. `file`: the cache's name.
std::string describe_truth_times(const std::string& file, const Pc2Reader& truth, const Clip& clip);

}  // namespace bodyopt
