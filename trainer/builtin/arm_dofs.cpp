#include "trainer/builtin/arm_dofs.h"

#include <set>
#include <string>

#include "runtime/core/error.h"
#include "trainer/builtin/anatomy.h"

namespace bodyopt {
namespace {

using Eigen::Vector3d;

std::uint32_t find_joint(const Skeleton& skeleton, const std::string& name) {
  const int joint = skeleton.find(name);
  if (joint < 0) {
    throw Error(ErrorKind::mismatch,
                "the skeleton has no joint '" + name + "': the built-in motions are made for the built-in arm only");
  }
  return static_cast<std::uint32_t>(joint);
}

struct Turn {
  const char* joint;
  Vector3d axis;
  double share = 1;
};

}  // namespace

JointLimits arm_limits(const Skeleton& skeleton) {
  const SegmentFrame arm = upper_arm_frame(), fore = forearm_frame(), hand = hand_frame();
  const Vector3d up = Vector3d::UnitY(), forward = Vector3d::UnitZ();
  const Vector3d thumb = hand.front - 0.5 * hand.along - 0.4 * hand.side;
  struct Dof {
    const char* name;
    double rest, min, max;  // degrees
    std::vector<Turn> turns;
  };
  const Dof dofs[kArmDofCount] = {
      {"clavicle_elevation", 0, -8, 20, {{"clavicle", -forward}}},      // up
      {"clavicle_protraction", 0, -15, 18, {{"clavicle", up}}},         // forwards
      {"shoulder_abduction", 50, 24, 115, {{"shoulder", -arm.front}}},  // sideways and up, beside the clavicle's share
      {"shoulder_flexion", 0, -35, 80, {{"shoulder", arm.side}}},       // forwards
      {"shoulder_rotation", 0, -50, 50, {{"shoulder", -arm.along}}},    // of the humerus about itself, inwards
      {"elbow_flexion", 20, 0, 130, {{"elbow", fore.side}}},
      {"forearm_twist", 0, -75, 75, {{"forearm", fore.along, 0.5}, {"forearm_twist", fore.along, 0.5}}},  // supination
      {"wrist_flexion", 0, -55, 60, {{"wrist", hand.front}}},    // towards the palm
      {"wrist_deviation", 0, -20, 28, {{"wrist", -hand.side}}},  // towards the little finger
      {"finger_curl", 12, 0, 75, {{"fingers", hand.front}, {"fingertips", hand.front, 1.1}, {"thumb", thumb, 0.4}}},
  };
  JointLimits limits;
  for (const Dof& dof : dofs) {
    DegreeOfFreedom& added = limits.dofs.emplace_back();
    added.name = dof.name;
    added.rest = dof.rest;
    added.min = dof.min;
    added.max = dof.max;
    for (const Turn& turn : dof.turns) {
      const Vector3d axis = turn.axis.normalized();
      added.turns.push_back({find_joint(skeleton, turn.joint), {axis.x(), axis.y(), axis.z()}, turn.share});
    }
  }
  // Joints that one degree of freedom turns together are told apart; the others have degrees of freedom of their own,
  // and go a little beyond them, as motion that comes from elsewhere does.
  const std::set<std::string> coupled = {"forearm", "forearm_twist", "fingers", "fingertips", "thumb"};
  std::set<std::string> driven;
  for (const Dof& dof : dofs) {
    for (const Turn& turn : dof.turns) driven.insert(turn.joint);
  }
  for (const std::string& name : driven) {
    limits.deviations.push_back({find_joint(skeleton, name), coupled.contains(name) ? 20.0 : 10.0});
  }
  return limits;
}

}  // namespace bodyopt
