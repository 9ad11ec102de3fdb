// The systematic part of a range of motion: every degree of freedom alone, then neighbours together.
#pragma once

#include "trainer/motion/body_spheres.h"
#include "trainer/motion/limited_pose.h"

namespace bodyopt {

// From rest to the lower limit, the upper limit and back, one degree of freedom after the other, the others at rest:
// in steps of kSweepStep degrees, or longer ones where `most` frames are too few.
std::vector<Angles> sweeps(const JointLimits& limits, std::size_t most);

// The four corners of the limits of every pair (see dof_pairs), others at rest. A key holds corners of several pairs
// that do not touch each other. Corners in which limbs overlap are left out. `most` frames at most.
std::vector<Angles> pair_blends(const JointLimits& limits, const Skeleton& skeleton, const SelfOverlap& overlap,
                                std::size_t most);

inline constexpr double kSweepStep = 10;  // degrees
inline constexpr double kBlendStep = 20;  // degrees

}  // namespace bodyopt
