// How far the joints of a character may turn.
#pragma once

#include <optional>
#include <vector>

#include "trainer/motion/joint_limits.h"

namespace bodyopt {

// Of a joint's turn away from the bind pose, as angles about its own axes (see euler_angles.h), degrees.
struct JointRange {
  Vec3 low{}, high{};
};

// Of every joint of the skeleton: as far as one of its degrees of freedom goes, and of one that is oblique to the axes
// the part along each. Axes that none turns about are held. None: a root, or a joint without any.
std::vector<std::optional<JointRange>> joint_ranges(const JointLimits& limits, const Skeleton& skeleton);

// Local rotations. `clip` turned by `degrees`, axis by axis as far as the range lets it; an angle that the clip has
// beyond the range comes back, but goes no further.
Quat turned_within(const JointRange& range, const Quat& bind, const Quat& clip, const Vec3& degrees);

// What may be added to a clip's rotation about each axis alone; always zero, too.
JointRange turns_within(const JointRange& range, const Quat& bind, const Quat& clip);

}  // namespace bodyopt
