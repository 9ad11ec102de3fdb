// Joint limits of a rig that nobody has written any for: what its clips show, and rules where they show nothing.
#pragma once

#include <vector>

#include "assets/characters/character.h"
#include "trainer/motion/joint_limits.h"

namespace bodyopt::trainer {

// Three degrees of freedom for every joint that moves some of the skin against the rest. A root moves all of it, and
// there may be several above each other. The "NAME twist" is about its bone. The "NAME bend" is about the axis across
// it that the poses turn it about most, or else nearly left-right. The "NAME side" is about the third. The bind pose
// counts as 0. A joint that some of the poses turn by 2 degrees or more gets their range, widened by a tenth and a
// degree. It is cut where the three angles get ambiguous. Any other gets a range by its place in the skeleton, whatever
// the body. That is a fork (trunk, pelvis, hand), a chain (limb, neck, tail, finger) or its tip. A joint deviates by a
// quarter of its widest range, 15 degrees at most. Every number has its source. Joints that are detached from their
// limb (detached_joints) are judged as if they hung there, and named. Throws Error(mismatch) where there is no such
// joint.
JointLimits first_limits(const Character& character, const std::vector<Pose>& poses);

}  // namespace bodyopt::trainer
