// Joint limits of a rig that nobody has written any for: what its clips show, and rules where they show nothing.
#pragma once

#include <vector>

#include "assets/character.h"
#include "trainer/motion/joint_limits.h"

namespace bodyopt {

// Three degrees of freedom for every joint below the root that moves skin: "NAME bend" and "NAME side" about axes
// across its bone, "NAME twist" about the bone; the bind pose counts as 0. A joint that some of the poses turn by 2
// degrees or more gets their range, widened by a tenth and a degree. Any other gets a range by where it stands in the
// skeleton, whatever the body: at a fork (trunk, pelvis, hand), in a chain (limb, neck, tail, finger) or at its tip. A
// joint deviates by a quarter of its widest range, 15 degrees at most. Every degree of freedom tells its source. Throws
// Error(mismatch) where no joint below the root moves skin.
JointLimits first_limits(const Character& character, const std::vector<Pose>& poses);

}  // namespace bodyopt
