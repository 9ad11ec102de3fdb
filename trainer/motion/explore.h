// The random part of a range of motion: it goes where it has not been.
#pragma once

#include <cstdint>

#include "trainer/motion/body_spheres.h"
#include "trainer/motion/dof_groups.h"
#include "trainer/motion/limited_pose.h"

namespace bodyopt {

// Uniform numbers from 0 to 1, the same on every machine.
class UniformRandom {
 public:
  explicit UniformRandom(std::uint64_t seed) : state_(seed) {}
  double next();
  std::size_t below(std::size_t count);
  Vec3 in_ball();  // anywhere not further than 1 from the origin

 private:
  std::uint64_t state_;
};

// Angles anywhere within the limits.
Angles random_angles(const JointLimits& limits, UniformRandom& random);

struct ExploreOptions {
  std::size_t frames;
  std::uint64_t seed;
  double step;  // degrees that an angle or a deviation changes from a frame to the next, at most
};

// Each group (of degrees of freedom that share joints) goes straight to the candidate (of kTargetCandidates random
// ones) that lies farthest from where the group has been, in `covered` and since; then to the next. Candidates lie
// anywhere within the limits or between two common poses, and joints turn beside that by as much as their deviations
// allow. Groups move at the same time, each at its own pace. Groups whose limbs would overlap choose again. Shows
// progress.
std::vector<Posture> explore(const JointLimits& limits, const Skeleton& skeleton, const SelfOverlap& overlap,
                             const std::vector<Posture>& covered, const ExploreOptions& options);

}  // namespace bodyopt
