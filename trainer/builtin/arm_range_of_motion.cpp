#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "runtime/basis/error.h"
#include "trainer/builtin/arm.h"
#include "trainer/builtin/arm_dofs.h"

namespace bodyopt {
namespace {

constexpr double kSweepShare = 0.3;   // of the frames
constexpr double kClearance = 0.003;  // metres between flesh and ribs
constexpr int kTriesPerFrame = 200;

// Degrees of freedom that bend the same flesh: their extremes are also taken together.
constexpr ArmDof kPairs[][2] = {
    {kShoulderAbduction, kShoulderFlexion}, {kShoulderAbduction, kShoulderRotation},
    {kShoulderFlexion, kShoulderRotation},  {kClavicleElevation, kShoulderAbduction},
    {kShoulderFlexion, kElbowFlexion},      {kElbowFlexion, kForearmTwist},
    {kForearmTwist, kWristFlexion},         {kWristFlexion, kFingerCurl},
};

double between(const DofLimits& limits, double share) { return limits.low + share * (limits.high - limits.low); }

// From the low to the high limit of one angle, the others at rest.
void add_sweeps(std::vector<ArmAngles>& frames, int steps) {
  for (int dof = 0; dof < kArmDofCount; ++dof) {
    for (int step = 0; step < steps; ++step) {
      ArmAngles angles = arm_rest_angles();
      angles[dof] = between(kArmLimits[dof], static_cast<double>(step) / (steps - 1));
      frames.push_back(angles);
    }
  }
}

void add_pairs(std::vector<ArmAngles>& frames, const Skeleton& skeleton) {
  for (const auto& [first, second] : kPairs) {
    for (const double a : {0.0, 1.0}) {
      for (const double b : {a, 1 - a}) {  // neighbouring corners differ in one angle only
        ArmAngles angles = arm_rest_angles();
        angles[first] = between(kArmLimits[first], a);
        angles[second] = between(kArmLimits[second], b);
        if (torso_clearance(skeleton, angles) > kClearance) frames.push_back(angles);
      }
    }
  }
}

// Evenly spread points of the box of limits: the additive recurrence of the generalised golden ratio (Roberts 2018),
// started at a random place.
class EvenAngles {
 public:
  explicit EvenAngles(std::uint64_t seed) {
    double ratio = 1.5;
    for (int k = 0; k < 60; ++k) ratio = std::pow(1 + ratio, 1.0 / (kArmDofCount + 1));
    std::mt19937_64 random(seed);
    for (int k = 0; k < kArmDofCount; ++k) {
      step_[k] = std::pow(ratio, -(k + 1));
      at_[k] = static_cast<double>(random() >> 11) * 0x1p-53;
    }
  }

  ArmAngles next() {
    ArmAngles angles;
    for (int k = 0; k < kArmDofCount; ++k) {
      at_[k] = std::fmod(at_[k] + step_[k], 1.0);
      angles[k] = between(kArmLimits[k], at_[k]);
    }
    return angles;
  }

 private:
  std::array<double, kArmDofCount> step_;
  std::array<double, kArmDofCount> at_;
};

std::vector<ArmAngles> blends(const Skeleton& skeleton, std::size_t count, std::uint64_t seed) {
  EvenAngles even(seed);
  std::vector<ArmAngles> found;
  for (std::size_t tries = 0; found.size() < count && tries < kTriesPerFrame * count; ++tries) {
    const ArmAngles angles = even.next();
    if (torso_clearance(skeleton, angles) > kClearance) found.push_back(angles);
  }
  return found;
}

double difference(const ArmAngles& a, const ArmAngles& b) {
  double sum = 0;
  for (int k = 0; k < kArmDofCount; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return sum;
}

// Each pose is followed by the nearest one left, so that the clip can be watched.
void order_by_nearness(std::vector<ArmAngles>& frames, const ArmAngles& start) {
  ArmAngles last = start;
  for (auto next = frames.begin(); next != frames.end(); ++next) {
    std::iter_swap(next, std::min_element(next, frames.end(), [&](const ArmAngles& a, const ArmAngles& b) {
                     return difference(a, last) < difference(b, last);
                   }));
    last = *next;
  }
}

}  // namespace

Clip arm_range_of_motion(const Skeleton& skeleton, int frame_count, std::uint64_t seed) {
  if (frame_count < 1)
    throw Error(ErrorKind::usage, "a clip needs 1 frame or more, not " + std::to_string(frame_count));
  const std::size_t count = static_cast<std::size_t>(frame_count);
  std::vector<ArmAngles> frames{arm_rest_angles()};
  add_sweeps(frames, std::max(2, static_cast<int>(kSweepShare * frame_count / kArmDofCount)));
  if (frames.size() < count) add_pairs(frames, skeleton);
  if (frames.size() < count) {
    std::vector<ArmAngles> rest = blends(skeleton, count - frames.size(), seed);
    order_by_nearness(rest, frames.back());
    frames.insert(frames.end(), rest.begin(), rest.end());
  }
  frames.resize(count, arm_rest_angles());

  Clip clip;
  clip.name = "range_of_motion";
  for (const ArmAngles& angles : frames) clip.poses.push_back(arm_pose(skeleton, angles));
  return clip;
}

}  // namespace bodyopt
