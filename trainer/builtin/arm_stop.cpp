#include <algorithm>
#include <array>

#include "trainer/builtin/arm.h"
#include "trainer/builtin/arm_dofs.h"
#include "trainer/motion/limited_pose.h"

namespace bodyopt {
namespace {

constexpr int kFrames = 60;  // 2.5 s

// Degrees, in the order of ArmDof: the arm hangs and is thrown up to the side, nearly straight.
constexpr std::array<double, kArmDofCount> kBefore = {-4, 0, 24, 0, 0, 80, -10, 20, 0, 35};
constexpr std::array<double, kArmDofCount> kAfter = {14, 0, 104, 8, 0, 15, 0, 0, 0, 12};

// Metres that the torso sinks meanwhile, and lands.
constexpr double kDrop = 0.15;

// Speed rises evenly through the swing and falls to nothing in its last frame and a half.
double share_at(int frame) {
  constexpr double kBraking = 1.5, kLength = kStopEnds - kStopBegins;
  const double frames = std::clamp<double>(frame - kStopBegins, 0, kLength);
  const double rising = kLength - kBraking;
  if (frames <= rising) return frames * frames / (rising * kLength);
  const double left = kLength - frames;
  return 1 - left * left / (kBraking * kLength);
}

}  // namespace

Clip arm_stop(const Skeleton& skeleton) {
  const JointLimits limits = arm_limits(skeleton);
  Clip clip;
  clip.name = "stop";
  for (int frame = clip.first_frame; frame < clip.first_frame + kFrames; ++frame) {
    Angles angles(kArmDofCount);
    for (std::size_t dof = 0; dof < angles.size(); ++dof) {
      angles[dof] = kBefore[dof] + share_at(frame) * (kAfter[dof] - kBefore[dof]);
    }
    Pose pose = limited_pose(skeleton, limits, {angles});
    pose.joints[0].translation[1] += kDrop * (1 - share_at(frame));
    clip.poses.push_back(std::move(pose));
  }
  return clip;
}

}  // namespace bodyopt
