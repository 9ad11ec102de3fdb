// Turns of joints as sliders have them, about x, then y, then z, degrees; and how far the joints of a character may
// turn.
#pragma once

#include <optional>
#include <vector>

#include "runtime/core/transform.h"
#include "trainer/motion/joint_limits.h"

namespace bodyopt {

Quat turn_of(const Vec3& degrees);

// Of the angles that make the turn, those that are smallest in sum.
Vec3 degrees_of(const Quat& turn);

// Of a joint's turn, the one of the other side's joint that makes it the mirror
// image at the plane x = 0. `axes`, `other_axes`: rotations of the two in the bind pose, joint to world.
Vec3 mirrored_angles(const Vec3& degrees, const Quat& axes, const Quat& other_axes);

// Of a joint's turn away from the bind pose, as angles about its own axes, degrees.
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
