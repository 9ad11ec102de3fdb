#include "trainer/motion/coverage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "trainer/motion/explore.h"

namespace bodyopt {
namespace {

constexpr std::size_t kTriesPerSample = 50;

double angle_to_nearest(const Quat& q, std::uint32_t joint, const std::vector<std::vector<Quat>>& frames) {
  double closest = 0;  // the largest |cosine of half the angle|
  for (const std::vector<Quat>& frame : frames) {
    const Quat& other = frame[joint];
    closest = std::max(closest, std::abs(q[0] * other[0] + q[1] * other[1] + q[2] * other[2] + q[3] * other[3]));
  }
  return 2 * std::acos(std::min(1.0, closest)) * 180 / std::numbers::pi;
}

}  // namespace

std::vector<JointCoverage> coverage(const std::vector<Angles>& frames, const JointLimits& limits,
                                    const Skeleton& skeleton, const SelfOverlap& overlap, std::size_t samples,
                                    std::uint64_t seed) {
  std::vector<std::vector<Quat>> turns, fresh;
  for (const Angles& angles : frames) turns.push_back(joint_turns(skeleton.size(), limits, angles));
  UniformRandom random(seed);
  for (std::size_t k = 0; k < kTriesPerSample * samples && fresh.size() < samples; ++k) {
    const Angles angles = random_angles(limits, random);
    if (overlap.find(limited_pose(skeleton, limits, angles))) continue;
    fresh.push_back(joint_turns(skeleton.size(), limits, angles));
  }
  std::set<std::uint32_t> joints;
  for (const DegreeOfFreedom& dof : limits.dofs) {
    for (const JointTurn& turn : dof.turns) joints.insert(turn.joint);
  }
  std::vector<JointCoverage> result;
  for (const std::uint32_t joint : joints) {
    const double none = fresh.empty() ? std::numeric_limits<double>::quiet_NaN() : 0;
    JointCoverage measured{skeleton.joints[joint].name, none, none};
    for (const std::vector<Quat>& pose : fresh) {
      const double angle = angle_to_nearest(pose[joint], joint, turns);
      measured.mean += angle / static_cast<double>(fresh.size());
      measured.largest = std::max(measured.largest, angle);
    }
    result.push_back(measured);
  }
  return result;
}

}  // namespace bodyopt
