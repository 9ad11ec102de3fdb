// How much of the poses a character will take the frames of a clip show.
#pragma once

#include <cstdint>
#include <string>

#include "trainer/motion/body_spheres.h"
#include "trainer/motion/limited_pose.h"

namespace bodyopt {

// Degrees from the rotations that a joint is wanted to take to the nearest in any frame.
struct JointCoverage {
  std::string joint;
  double mean, largest;
};

// For every joint that leaves the bind pose in a wanted pose or a frame, in joint order; the root and joints of all
// skin are left out, as training learns nothing of how they turn. Not a number where no poses are wanted.
std::vector<JointCoverage> coverage(const std::vector<Pose>& frames, const std::vector<Pose>& wanted,
                                    const Character& character);

// Random poses within the limits in which no limbs overlap (those that would are drawn anew, limb by limb): `count`, or
// fewer where such poses are rare.
std::vector<Pose> random_poses(const JointLimits& limits, const Skeleton& skeleton, const SelfOverlap& overlap,
                               std::size_t count, std::uint64_t seed);

}  // namespace bodyopt
