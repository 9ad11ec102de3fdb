#include "trainer/motion/range_of_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "runtime/basis/error.h"
#include "trainer/motion/blend_clips.h"
#include "trainer/motion/body_spheres.h"
#include "trainer/motion/explore.h"
#include "trainer/motion/sweeps.h"
#include "trainer/motion/walk.h"

namespace bodyopt {
namespace {

constexpr double kSweepShare = 0.2, kPairShare = 0.1;  // of the frames
constexpr double kLeastStep = 20;                      // degrees

// N poses in the box of a ball joint's three angles stand about its width / cbrt(N) apart; smaller steps than that
// would show poses that have been seen.
double random_step(std::size_t frames) {
  constexpr double kWidth = 250;  // degrees
  return std::max(kLeastStep, kWidth / std::cbrt(static_cast<double>(frames)));
}

}  // namespace

RangeOfMotion range_of_motion(const Character& character, const JointLimits& limits,
                              const RangeOfMotionOptions& options) {
  if (options.frames < 1) {
    throw Error(ErrorKind::usage, "a clip needs 1 frame or more, not " + std::to_string(options.frames));
  }
  const Skeleton& skeleton = character.skeleton;
  const std::size_t count = static_cast<std::size_t>(options.frames);
  const auto share = [&](double part) { return static_cast<std::size_t>(part * static_cast<double>(count)); };
  RangeOfMotion result;
  std::vector<Angles>& frames = result.angles;
  const auto append = [&](const std::vector<Angles>& more) {
    const std::size_t added = std::min(more.size(), count - frames.size());
    frames.insert(frames.end(), more.begin(), more.begin() + static_cast<std::ptrdiff_t>(added));
    return added;
  };

  frames.push_back(rest_angles(limits));
  result.sweep_frames = append(sweeps(limits, share(kSweepShare)));
  SelfOverlap overlap = overlap_of_sweeps(character, limits);
  result.pair_frames = append(pair_blends(limits, skeleton, overlap, share(kPairShare)));
  result.random_frames = count - frames.size();
  result.step = result.random_frames > 0 ? random_step(result.random_frames) : 0;
  if (result.random_frames > 0 && options.examples.empty()) {
    append(explore(limits, skeleton, overlap, frames, {result.random_frames, options.seed, result.step}));
  } else if (result.random_frames > 0) {
    const std::vector<Pose> examples = in_place(skeleton, options.examples);
    for (const Pose& example : examples) overlap.trust(example);
    result.blends = blend_clips(examples, overlap, clip_of(result, limits, skeleton).poses,
                                {result.random_frames, options.seed, result.step});
  }
  for (std::size_t k = 1; k < frames.size(); ++k) {
    result.largest_step = std::max(result.largest_step, largest_change(frames[k - 1], frames[k]));
  }
  const Clip clip = clip_of(result, limits, skeleton);
  for (std::size_t k = frames.size(); k < clip.poses.size(); ++k) {
    result.largest_step = std::max(result.largest_step, largest_turn(clip.poses[k - 1], clip.poses[k]));
  }
  return result;
}

SelfOverlap overlap_of_sweeps(const Character& character, const JointLimits& limits) {
  // What one degree of freedom does alone is within the limits by the word of their author.
  SelfOverlap overlap(character);
  for (const Angles& angles : sweeps(limits, std::numeric_limits<std::size_t>::max())) {
    overlap.trust(limited_pose(character.skeleton, limits, angles));
  }
  return overlap;
}

Clip clip_of(const RangeOfMotion& motion, const JointLimits& limits, const Skeleton& skeleton) {
  Clip clip;
  clip.name = "range_of_motion";
  for (const Angles& angles : motion.angles) clip.poses.push_back(limited_pose(skeleton, limits, angles));
  clip.poses.insert(clip.poses.end(), motion.blends.begin(), motion.blends.end());
  return clip;
}

}  // namespace bodyopt
