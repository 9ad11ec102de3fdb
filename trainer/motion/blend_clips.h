// The random part of a range of motion where clips are given: a walk among blends of their poses.
#pragma once

#include <cstdint>
#include <vector>

#include "trainer/motion/body_spheres.h"
#include "trainer/motion/limited_pose.h"

namespace bodyopt {

struct BlendOptions {
  std::size_t frames;
  std::uint64_t seed;
  double step;                               // degrees that a joint turns from a frame to the next, at most
  std::vector<JointDeviation> deviations{};  // by which joints turn beside
};

// Straight to the blend (every joint's rotation on the shortest way) of two examples (of kCandidates random ones) whose
// joints are furthest from all poses so far, `covered` first; then to the next. Joints deviate from the blends. Limbs
// may overlap as `overlap` allows; where they would on the way, the walk jumps to its end. Examples are not held to any
// limits: what the clips do, the character does.
std::vector<Pose> blend_clips(const std::vector<Pose>& examples, const SelfOverlap& overlap,
                              const std::vector<Pose>& covered, const BlendOptions& options);

// The largest angle between the rotations of a joint, degrees.
double largest_turn(const Pose& from, const Pose& to);

// A clip's poses as blends have them: without the root's motion, and every joint as far from its parent as at rest.
std::vector<Pose> in_place(const Skeleton& skeleton, const std::vector<Pose>& poses);

}  // namespace bodyopt
