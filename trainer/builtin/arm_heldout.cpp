#include <algorithm>
#include <array>
#include <iterator>
#include <string>

#include "runtime/core/error.h"
#include "trainer/builtin/arm.h"
#include "trainer/builtin/arm_dofs.h"
#include "trainer/motion/limited_pose.h"

namespace bodyopt {
namespace {

using ArmAngles = std::array<double, kArmDofCount>;  // degrees

struct Key {
  double seconds;
  ArmAngles angles;  // in the order of ArmDof, degrees
};

constexpr Key kActing[] = {
    // Hanging, then reaching up.
    {0.0, {1, 0, 26, 6, 8, 28, -8, 4, 3, 26}},
    {0.8, {15, 4, 104, 38, -14, 22, 18, -18, -4, 6}},
    {1.1, {16, 5, 106, 41, -16, 18, 21, -21, -5, 4}},
    // Curling the fist to the shoulder.
    {1.8, {2, -3, 34, 12, -22, 44, 40, 6, 2, 48}},
    {2.5, {6, 3, 39, 24, -18, 121, 58, 28, 4, 62}},
    {2.8, {7, 4, 41, 27, -20, 125, 60, 31, 3, 66}},
    // Throwing: wind up, release, follow through.
    {3.5, {9, -11, 88, -18, -44, 98, 12, -34, 7, 34}},
    {3.9, {6, 13, 72, 58, 16, 24, -34, 12, 9, 14}},
    {4.3, {-3, 15, 36, 46, 28, 38, -52, 33, 12, 19}},
    // Turning a key.
    {4.9, {1, 2, 41, 31, 9, 68, -66, -8, -9, 31}},
    {5.4, {1, 2, 43, 33, 6, 71, 63, 9, 13, 29}},
    {5.8, {2, 1, 42, 30, 8, 66, -48, -5, -6, 33}},
    // Waving.
    {6.5, {11, 5, 82, 14, -46, 92, -22, -12, -11, 11}},
    {6.8, {11, 5, 84, 15, -43, 80, -26, 11, 19, 9}},
    {7.1, {12, 6, 81, 17, -48, 101, -19, -16, -13, 12}},
    {7.4, {11, 6, 83, 13, -44, 82, -24, 9, 17, 10}},
    {8.2, {2, 1, 29, 9, 11, 33, -5, 7, 4, 28}},
};

// Seconds each angle is late: a limb starts at the shoulder and the hand follows.
constexpr ArmAngles kLag = {0, 0, 0.02, 0.02, 0.03, 0.06, 0.08, 0.11, 0.11, 0.14};

// Starts and stops with no speed and no acceleration.
double ease(double t) { return t * t * t * (10 - 15 * t + 6 * t * t); }

double angle_at(int dof, double seconds) {
  const Key* after =
      std::find_if(std::begin(kActing), std::end(kActing), [&](const Key& k) { return k.seconds > seconds; });
  if (after == std::begin(kActing)) return after->angles[dof];
  if (after == std::end(kActing)) return std::prev(after)->angles[dof];
  const Key& before = *std::prev(after);
  const double share = ease((seconds - before.seconds) / (after->seconds - before.seconds));
  return before.angles[dof] + share * (after->angles[dof] - before.angles[dof]);
}

}  // namespace

Clip arm_heldout(const Skeleton& skeleton, int frame_count) {
  if (frame_count < 1)
    throw Error(ErrorKind::usage, "a clip needs 1 frame or more, not " + std::to_string(frame_count));
  const double length = std::prev(std::end(kActing))->seconds + *std::max_element(kLag.begin(), kLag.end());
  const JointLimits limits = arm_limits(skeleton);
  Clip clip;
  clip.name = "heldout";
  for (int frame = 0; frame < frame_count; ++frame) {
    const double seconds = length * (frame + 0.5) / frame_count;
    Angles angles(kArmDofCount);
    for (int dof = 0; dof < kArmDofCount; ++dof) angles[dof] = angle_at(dof, seconds - kLag[dof]);
    clip.poses.push_back(limited_pose(skeleton, limits, {angles}));
  }
  return clip;
}

}  // namespace bodyopt
