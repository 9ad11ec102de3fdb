// How far the sliders of a joint go.
#pragma once

#include <vector>

#include "proxy_viewer/snapshot.h"
#include "trainer/motion/joint_limits.h"

namespace bodyopt {

// Of every joint of the skeleton, about its own axes and away from the bind pose: what its degrees of freedom allow,
// each about the axis that it is nearest to. Axes that no degree of freedom turns about are held; joints that have
// none, and roots, keep what they have.
void limit_joints(const JointLimits& limits, const Skeleton& skeleton, std::vector<JointRow>& rows);

}  // namespace bodyopt
