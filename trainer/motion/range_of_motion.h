// A clip that shows a character's whole range of motion, for training.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "assets/characters/character.h"
#include "assets/clips/clip.h"
#include "trainer/motion/explore.h"
#include "trainer/motion/held_turns.h"

namespace bodyopt::trainer {

// The random part of a range of motion where clips are given: a walk among blends of their poses.

struct BlendOptions {
  std::size_t frames;
  std::uint64_t seed;
  double step;                               // degrees that a joint turns from a frame to the next, at most
  std::vector<JointDeviation> deviations{};  // by which joints turn beside
};

// Goes straight to a blend of two examples (every joint's rotation on the shortest way), then to the next. Of
// kPoseCandidates random ones it is that whose joints are furthest from all poses so far, `covered` first. Joints
// deviate from the blends. Limbs may overlap as `overlap` allows. Where they would on the way, other blends are tried,
// then the walk jumps to its end. Examples are not held to any limits: what the clips do, the character does.
std::vector<Pose> blend_clips(const std::vector<Pose>& examples, const SelfOverlap& overlap,
                              const std::vector<Pose>& covered, const BlendOptions& options);

// The largest angle between the rotations of a joint, degrees.
double largest_turn(const Pose& from, const Pose& to);

// A clip's poses as blends have them: without the root's motion, and every joint as far from its parent as at rest.
std::vector<Pose> in_place(const Skeleton& skeleton, const std::vector<Pose>& poses);

struct RangeOfMotionOptions {
  int frames = 3200;
  std::uint64_t seed = 1;
  std::vector<Pose> examples{};  // random poses are blends of two of these; empty: of common ones, or anywhere
  double step = 360;             // degrees that any joint may turn from a random frame to the next: here as it likes
  double blends = 1;             // share of the random poses that are blends, where there are examples
};

struct RangeOfMotion {
  std::vector<Posture> postures;  // per frame that the limits made: of all but blends of examples
  std::vector<Pose> blends;       // the random frames that are blends of examples
  // Frames after frame 1, which is the rest pose.
  std::size_t sweep_frames = 0, pair_frames = 0, touching_frames = 0, random_frames = 0;
  double largest_step = 0;  // degrees, of any angle, or of any joint from and to blends, between two frames
};

// Frame 1 is the rest pose; then come sweeps and pair blends (at most kSweepShare and kPairShare of the frames). Poses
// in which limbs touch (kTouchShare) follow unless all random poses are blends or steps are limited. The rest are
// random poses, in most of which all joints deviate. The same for the same seed, on any number of threads. Throws
// Error(usage) for less than a frame.
RangeOfMotion range_of_motion(const Character& character, const JointLimits& limits,
                              const RangeOfMotionOptions& options);

// The fewest frames in which every degree of freedom is swept from end to end.
std::size_t frames_for_sweeps(const JointLimits& limits);

// The overlaps that limbs may have: as much as when one degree of freedom alone is swept, and in common poses.
SelfOverlap overlap_of_limits(const Character& character, const JointLimits& limits);

// 24 frames a second.
Clip clip_of(const RangeOfMotion& motion, const JointLimits& limits, const Skeleton& skeleton);

// Degrees from the rotations that a joint is wanted to take to the nearest in any frame.
struct JointCoverage {
  std::string joint;
  double mean, largest;
};

// Measures every joint that leaves the bind pose in a wanted pose or a frame, in joint order. The root and joints of
// all skin are left out, as training learns nothing of how they turn. Not a number where no poses are wanted.
std::vector<JointCoverage> coverage(const std::vector<Pose>& frames, const std::vector<Pose>& wanted,
                                    const Character& character);

// Random poses within the limits in which no limbs overlap: `count`, or fewer where such poses are rare. Those that
// would overlap are drawn anew, limb by limb.
std::vector<Pose> random_poses(const JointLimits& limits, const Skeleton& skeleton, const SelfOverlap& overlap,
                               std::size_t count, std::uint64_t seed);

}  // namespace bodyopt::trainer
