// Motion that shows what a character does.
#pragma once

#include <string>
#include <vector>

#include "runtime/basis/skeleton.h"

namespace bodyopt::cli {

// The poses of some clips, 24 a second. Says their notes. Throws as read_clip(). `unit`: of the character; `joint_map`:
// empty for none.
std::vector<Pose> read_poses(const std::vector<std::string>& sources, const Skeleton& skeleton, double unit,
                             const std::string& joint_map);

}  // namespace bodyopt::cli
