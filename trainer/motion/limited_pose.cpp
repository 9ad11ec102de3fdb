#include "trainer/motion/limited_pose.h"

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

}  // namespace bodyopt
