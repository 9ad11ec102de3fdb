#include "trainer/motion/limited_pose.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/host/rig.h"

namespace bodyopt {

Angles rest_angles(const JointLimits& limits) {
  Angles angles;
  for (const DegreeOfFreedom& dof : limits.dofs) angles.push_back(dof.rest);
  return angles;
}

std::vector<Quat> joint_turns(std::size_t joint_count, const JointLimits& limits, const Posture& posture) {
  std::vector<Quat> turns(joint_count, Quat{0, 0, 0, 1});
  for (std::size_t k = 0; k < limits.dofs.size(); ++k) {
    const double away = (posture.angles[k] - limits.dofs[k].rest) * std::numbers::pi / 180;
    for (const JointTurn& turn : limits.dofs[k].turns) {
      turns[turn.joint] = turns[turn.joint] * axis_angle(turn.axis, turn.share * away);
    }
  }
  for (std::size_t j = 0; j < posture.deviations.size(); ++j) {
    const double degrees = length(posture.deviations[j]);
    if (!(degrees > 0)) continue;
    turns[j] = axis_angle((1 / degrees) * posture.deviations[j], degrees * std::numbers::pi / 180) * turns[j];
  }
  return turns;
}

Pose limited_pose(const Skeleton& skeleton, const JointLimits& limits, const Posture& posture) {
  const std::vector<Quat> turns = joint_turns(skeleton.size(), limits, posture), world = bind_rotations(skeleton);
  Pose pose = bind_pose(skeleton);
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    Quat& own = pose.joints[j].rotation;
    own = normalized(own * (conjugate(world[j]) * turns[j] * world[j]));
  }
  return pose;
}

double angle_of(const Quat& q) { return angle_between({0, 0, 0, 1}, q) * 180 / std::numbers::pi; }

double largest_change(const Angles& from, const Angles& to) {
  double largest = 0;
  for (std::size_t k = 0; k < from.size(); ++k) largest = std::max(largest, std::abs(to[k] - from[k]));
  return largest;
}

double largest_change(const Posture& from, const Posture& to) {
  double largest = largest_change(from.angles, to.angles);
  const auto deviation = [](const Posture& posture, std::size_t j) {
    return j < posture.deviations.size() ? posture.deviations[j] : Vec3{};
  };
  for (std::size_t j = 0; j < std::max(from.deviations.size(), to.deviations.size()); ++j) {
    largest = std::max(largest, length(deviation(to, j) - deviation(from, j)));
  }
  return largest;
}

std::size_t steps_between(const Angles& from, const Angles& to, double step) {
  return static_cast<std::size_t>(std::ceil(largest_change(from, to) / step - 1e-9));
}

void walk(const Angles& from, const Angles& to, double step, std::vector<Angles>& frames) {
  const std::size_t steps = steps_between(from, to, step);
  for (std::size_t s = 1; s < steps; ++s) {
    const double t = static_cast<double>(s) / static_cast<double>(steps);
    Angles between(from.size());
    for (std::size_t k = 0; k < from.size(); ++k) between[k] = from[k] + t * (to[k] - from[k]);
    frames.push_back(between);
  }
  if (steps > 0) frames.push_back(to);
}

}  // namespace bodyopt
