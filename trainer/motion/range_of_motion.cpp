#include "trainer/motion/range_of_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "runtime/core/error.h"
#include "trainer/motion/blend_clips.h"
#include "trainer/motion/body_spheres.h"
#include "trainer/motion/explore.h"
#include "trainer/motion/sweeps.h"
#include "trainer/motion/walk.h"

namespace bodyopt {
namespace {

constexpr double kSweepShare = 0.06, kPairShare = 0.04;  // of the frames

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
  std::vector<Posture>& frames = result.postures;
  const auto append = [&](const std::vector<Angles>& more) {
    const std::size_t added = std::min(more.size(), count - frames.size());
    for (std::size_t k = 0; k < added; ++k) frames.push_back({more[k]});
    return added;
  };

  frames.push_back({rest_angles(limits)});
  result.sweep_frames = append(sweeps(limits, share(kSweepShare)));
  SelfOverlap overlap = overlap_of_limits(character, limits);
  result.pair_frames = append(pair_blends(limits, skeleton, overlap, share(kPairShare)));
  result.random_frames = count - frames.size();
  if (result.random_frames > 0 && options.examples.empty()) {
    const std::vector<Posture> random =
        explore(limits, skeleton, overlap, frames, {result.random_frames, options.seed, options.step});
    frames.insert(frames.end(), random.begin(), random.end());
  } else if (result.random_frames > 0) {
    const std::vector<Pose> examples = in_place(skeleton, options.examples);
    for (const Pose& example : examples) overlap.trust(example);
    result.blends = blend_clips(examples, overlap, clip_of(result, limits, skeleton).poses,
                                {result.random_frames, options.seed, options.step, limits.deviations});
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

std::size_t frames_for_sweeps(const JointLimits& limits) {
  constexpr double kFramesOfOne = 3;  // its two ends, and rest
  return static_cast<std::size_t>(std::ceil(kFramesOfOne * static_cast<double>(limits.dofs.size()) / kSweepShare));
}

SelfOverlap overlap_of_limits(const Character& character, const JointLimits& limits) {
  // What one degree of freedom does alone is within the limits by the word of their author.
  SelfOverlap overlap(character);
  for (const Angles& angles : sweeps(limits, std::numeric_limits<std::size_t>::max())) {
    overlap.trust(limited_pose(character.skeleton, limits, {angles}));
  }
  for (const CommonPose& pose : limits.poses) overlap.trust(limited_pose(character.skeleton, limits, {pose.angles}));
  return overlap;
}

Clip clip_of(const RangeOfMotion& motion, const JointLimits& limits, const Skeleton& skeleton) {
  Clip clip;
  clip.name = "range_of_motion";
  for (const Posture& posture : motion.postures) clip.poses.push_back(limited_pose(skeleton, limits, posture));
  clip.poses.insert(clip.poses.end(), motion.blends.begin(), motion.blends.end());
  return clip;
}

}  // namespace bodyopt
