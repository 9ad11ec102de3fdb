#include "trainer/motion/joint_coverage.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/host/rig.h"
#include "trainer/motion/explore.h"

namespace bodyopt {
namespace {

constexpr std::size_t kTriesPerSample = 50;
constexpr double kMoves = 0.1;  // degrees

double angle_between(const Quat& a, const Quat& b) { return angle_of(conjugate(a) * b); }

std::vector<Quat> rotations(const std::vector<Pose>& poses, std::uint32_t joint) {
  std::vector<Quat> result;
  for (const Pose& pose : poses) result.push_back(normalized(pose.joints[joint].rotation));
  return result;
}

double angle_to_nearest(const Quat& q, const std::vector<Quat>& others) {
  const auto cosine = [&](const Quat& o) { return std::abs(q[0] * o[0] + q[1] * o[1] + q[2] * o[2] + q[3] * o[3]); };
  return angle_between(q, *std::max_element(others.begin(), others.end(),
                                            [&](const Quat& a, const Quat& b) { return cosine(a) < cosine(b); }));
}

}  // namespace

std::vector<JointCoverage> coverage(const std::vector<Pose>& frames, const std::vector<Pose>& wanted,
                                    const Skeleton& skeleton) {
  std::vector<JointCoverage> result;
  for (const std::uint32_t joint : feature_joints(skeleton)) {
    const Quat bind = normalized(skeleton.joints[joint].bind.rotation);
    const std::vector<Quat> shown = rotations(frames, joint), asked = rotations(wanted, joint);
    const auto moves = [&](const Quat& q) { return angle_between(q, bind) > kMoves; };
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
  for (std::size_t k = 0; k < kTriesPerSample * count && poses.size() < count; ++k) {
    Pose pose = limited_pose(skeleton, limits, {random_angles(limits, random)});
    if (!overlap.find(pose)) poses.push_back(std::move(pose));
  }
  return poses;
}

}  // namespace bodyopt
