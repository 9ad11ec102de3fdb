// The random part of a range of motion: it goes where it has not been.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "assets/characters/character.h"
#include "trainer/motion/held_turns.h"
#include "trainer/motion/joint_limits.h"

namespace bodyopt::trainer {

// Degrees of freedom that move the same flesh.

using DofGroup = std::vector<std::size_t>;  // indices of degrees of freedom, ascending

// Degrees of freedom that turn a joint in common, directly or through others, are one group.
std::vector<DofGroup> dof_groups(const JointLimits& limits);

// Pairs that turn the same joint, or a joint and its parent.
std::vector<std::array<std::size_t, 2>> dof_pairs(const JointLimits& limits, const Skeleton& skeleton);

// The joints that move joint `a` relative to joint `b`: from both up to, and without, their common ancestor.
std::set<std::uint32_t> joints_between(const Skeleton& skeleton, std::uint32_t a, std::uint32_t b);

// A body as spheres that fill its skin, to find poses in which limbs go through each other.

struct BodySphere {
  std::uint32_t joint;  // the sphere moves rigidly with it
  Vec3 centre;          // rest space, metres
  double radius;        // metres
};

// Inscribed spheres of the skin by ball shrinking (Ma, Bae and Choi 2012), the largest first for each joint, 24 at
// most. Their centres stand at least 0.6 of the larger one's radius apart.
std::vector<BodySphere> body_spheres(const Character& character);

// Limbs that overlap in a pose, beyond what poses that are trusted do.
class SelfOverlap {
 public:
  explicit SelfOverlap(const Character& character);

  // Overlaps as deep as in this pose count as flesh in contact from now on.
  void trust(const Pose& pose);

  // Two joints whose flesh overlaps more than any trusted pose's and the tolerance; nothing for a clear pose. Flesh of
  // a joint and its nearest ancestor with flesh is never compared: it is one piece.
  std::optional<std::pair<std::uint32_t, std::uint32_t>> find(const Pose& pose) const;

  // The two joints whose flesh overlaps most. `depth`: by how much more than find() lets pass, in parts of the radius
  // of the smaller sphere; 0 or less in a clear pose.
  struct Touch {
    std::pair<std::uint32_t, std::uint32_t> joints;
    double depth = 0;
  };
  Touch deepest(const Pose& pose) const;

 private:
  struct SpherePair {
    std::uint32_t first, second;
    double trusted = 0;  // depth, metres
  };
  std::vector<Vec3> posed_centres(const Pose& pose) const;
  double depth(const SpherePair& pair, const std::vector<Vec3>& centres) const;

  const Character& character_;
  std::vector<BodySphere> spheres_;
  std::vector<SpherePair> pairs_;
};

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

// Each group (of degrees of freedom that share joints) goes straight to one of kTargetCandidates random targets, then
// to the next. It is the one that lies farthest from where the group has been, in `covered` and since. Candidates lie
// anywhere within the limits or between two common poses, and joints also turn by as much as their deviations allow.
// Groups move at the same time, each at its own pace. Groups whose limbs would overlap choose again. Shows progress.
std::vector<Posture> explore(const JointLimits& limits, const Skeleton& skeleton, const SelfOverlap& overlap,
                             const std::vector<Posture>& covered, const ExploreOptions& options);

}  // namespace bodyopt::trainer
