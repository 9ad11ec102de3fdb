// The angles of a character's degrees of freedom in poses that come from elsewhere.
#pragma once

#include "trainer/dataset/clip.h"
#include "trainer/motion/limited_pose.h"

namespace bodyopt {

// Per frame, the angles within the limits whose rotations are nearest to the clip's, in the least-squares sense over
// the joints (Gauss-Newton with damping, started at the frame before). Joints without limits are left out.
std::vector<Angles> fit_angles(const Clip& clip, const JointLimits& limits, const Skeleton& skeleton);

}  // namespace bodyopt
