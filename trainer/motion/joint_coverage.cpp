#include "trainer/motion/joint_coverage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "assets/joints_with_skin.h"
#include "runtime/core/transformed.h"
#include "trainer/motion/explore.h"

namespace bodyopt {
namespace {

constexpr int kMostRedrawn = 50;  // times that limbs of a pose are in the way
constexpr int kMostLost = 20;     // poses in a row
constexpr double kMoves = 0.1;    // degrees

std::vector<Quat> rotations(const std::vector<Pose>& poses, std::uint32_t joint) {
  return transformed(poses, [&](const Pose& pose) { return normalized(pose.joints[joint].rotation); });
}

double angle_to_nearest(const Quat& q, const std::vector<Quat>& others) {
  const auto cosine = [&](const Quat& o) { return std::abs(q[0] * o[0] + q[1] * o[1] + q[2] * o[2] + q[3] * o[3]); };
  const auto further = [&](const Quat& a, const Quat& b) { return cosine(a) < cosine(b); };
  return angle_of(conjugate(q) * *std::max_element(others.begin(), others.end(), further));
}

bool turns_any(const DegreeOfFreedom& dof, const std::set<std::uint32_t>& joints) {
  return std::any_of(dof.turns.begin(), dof.turns.end(),
                     [&](const JointTurn& turn) { return joints.contains(turn.joint); });
}

// Limbs that are in each other's way are drawn anew, and these alone: of whole poses drawn anew hardly any would be
// clear where there are many joints.
std::optional<Pose> clear_pose(const JointLimits& limits, const Skeleton& skeleton, const SelfOverlap& overlap,
                               UniformRandom& random) {
  Angles angles = random_angles(limits, random);
  for (int redrawn = 0; redrawn < kMostRedrawn; ++redrawn) {
    Pose pose = limited_pose(skeleton, limits, {angles});
    const auto found = overlap.find(pose);
    if (!found) return pose;
    const std::set<std::uint32_t> between = joints_between(skeleton, found->first, found->second);
    const Angles others = random_angles(limits, random);
    for (std::size_t k = 0; k < angles.size(); ++k) {
      if (turns_any(limits.dofs[k], between)) angles[k] = others[k];
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<JointCoverage> coverage(const std::vector<Pose>& frames, const std::vector<Pose>& wanted,
                                    const Character& character) {
  const Skeleton& skeleton = character.skeleton;
  std::vector<JointCoverage> result;
  for (const std::uint32_t joint : joints_that_bend(character)) {
    const Quat bind = normalized(skeleton.joints[joint].bind.rotation);
    const std::vector<Quat> shown = rotations(frames, joint), asked = rotations(wanted, joint);
    const auto moves = [&](const Quat& q) { return angle_of(conjugate(q) * bind) > kMoves; };
    if (std::none_of(shown.begin(), shown.end(), moves) && std::none_of(asked.begin(), asked.end(), moves)) continue;
    const double none = asked.empty() ? std::numeric_limits<double>::quiet_NaN() : 0;
    JointCoverage measured{skeleton.joints[joint].name, none, none};
    for (const Quat& q : asked) {
      const double angle = angle_to_nearest(q, shown);
      measured.mean += angle / static_cast<double>(asked.size());
      measured.largest = std::max(measured.largest, angle);
    }
    result.push_back(measured);
  }
  return result;
}

std::vector<Pose> random_poses(const JointLimits& limits, const Skeleton& skeleton, const SelfOverlap& overlap,
                               std::size_t count, std::uint64_t seed) {
  UniformRandom random(seed);
  std::vector<Pose> poses;
  for (int lost = 0; lost < kMostLost && poses.size() < count; ++lost) {
    std::optional<Pose> pose = clear_pose(limits, skeleton, overlap, random);
    if (!pose) continue;
    poses.push_back(std::move(*pose));
    lost = -1;
  }
  return poses;
}

}  // namespace bodyopt
