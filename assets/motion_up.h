// Which axis of a motion's file is up.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "assets/source_motion.h"

namespace bodyopt {

// The axis that is called x, y, z, -x, -y or -z; nothing of any other name.
std::optional<Vec3> named_axis(const std::string& name);
std::string name_of_axis(const Vec3& axis);

// Every bone of the skeleton, which stands with y up, says by how far it goes up in the bind pose where up is in a
// frame. Where body and rest pose (`rest_up`; nothing where it is no pose) say different things, they are the body
// lying down or a rest pose that lies, and the axis wins along which the lowest joint keeps its height: feet, hands and
// knees meet one floor. Y, which nearly all files have up, wins where that does not tell. A note says so.
Vec3 up_of_motion(std::span<const SourceFrame> frames, std::span<const BonePair> bones,
                  const std::optional<Vec3>& rest_up, std::vector<std::string>& notes);

}  // namespace bodyopt
