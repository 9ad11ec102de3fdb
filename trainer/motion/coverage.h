// How much of the range of motion the frames of a clip show.
#pragma once

#include <cstdint>
#include <string>

#include "trainer/motion/body_spheres.h"
#include "trainer/motion/limited_pose.h"

namespace bodyopt {

// Degrees from random rotations of a joint within the limits to the nearest in any frame.
struct JointCoverage {
  std::string joint;
  double mean, largest;
};

// For every joint with limits, by `samples` fresh random poses in which no limbs overlap (fewer where such poses are
// rare; not a number where there are none).
std::vector<JointCoverage> coverage(const std::vector<Angles>& frames, const JointLimits& limits,
                                    const Skeleton& skeleton, const SelfOverlap& overlap, std::size_t samples,
                                    std::uint64_t seed);

}  // namespace bodyopt
