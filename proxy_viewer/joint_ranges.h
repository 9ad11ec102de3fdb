// How far the sliders of a joint go.
#pragma once

#include <vector>

#include "proxy_viewer/snapshot.h"
#include "trainer/motion/joint_limits.h"

namespace bodyopt {

// Of every joint of the skeleton, about its own axes and away from the bind pose: as far as one of its degrees of
// freedom goes, and of one that is oblique to the axes the part along each. Axes that none turns about are held; roots
// and joints without any keep what they have.
void limit_joints(const JointLimits& limits, const Skeleton& skeleton, std::vector<JointRow>& rows);

}  // namespace bodyopt
