// Finds the axis of a motion's file that is up.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "assets/clips/source_motion.h"

namespace bodyopt {

// The axis that is called x, y, z, -x, -y or -z; nothing of any other name.
std::optional<Vec3> named_axis(const std::string& name);
std::string name_of_axis(const Vec3& axis);

// Every bone of the skeleton, which stands with y up, votes for a frame's up by how far it goes up in the bind pose.
// The rest pose (`rest_up`; nothing where it is no pose) may disagree: the body or the rest pose lies down. Of the two
// y wins, which nearly all files have up, else the rest pose; without one the body wins over y. The other axis wins if
// the lowest joint keeps its height far better along it: feet, hands and knees meet one floor. A note says so.
Vec3 up_of_motion(std::span<const SourceFrame> frames, std::span<const BonePair> bones,
                  const std::optional<Vec3>& rest_up, std::vector<std::string>& notes);

}  // namespace bodyopt
