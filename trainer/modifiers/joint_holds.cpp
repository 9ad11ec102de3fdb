#include "trainer/modifiers/joint_holds.h"

#include <Eigen/Geometry>
#include <optional>

#include "assets/clips/joint_roles.h"
#include "runtime/basis/joint_omegas.h"
#include "runtime/core/error.h"
#include "runtime/host/rig.h"

namespace bodyopt::trainer {
namespace {

bool is_of_trunk(BodyPart part) {
  return part == BodyPart::hips || part == BodyPart::spine || part == BodyPart::clavicle;
}

// One flag for each joint; joints without a role are what the joint above them is.
std::vector<char> trunk_joints(const Skeleton& skeleton, const std::vector<std::optional<JointRole>>& roles) {
  std::vector<char> trunk;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    const bool inherited = parent < 0 || trunk[static_cast<std::size_t>(parent)];
    trunk.push_back(roles[j] ? is_of_trunk(roles[j]->part) : inherited);
  }
  return trunk;
}

}  // namespace

Eigen::VectorXd held_by(const Basis& basis, const std::vector<char>& chosen) {
  Eigen::VectorXd share = Eigen::VectorXd::Zero(basis.mesh.vertex_count());
  for (std::uint32_t v = 0; v < basis.mesh.vertex_count(); ++v) {
    for_each_omega(basis.ddm, v, [&](std::uint32_t joint, double omega) {
      if (chosen[joint]) share[v] += omega;
    });
  }
  return share.cwiseMax(0).cwiseMin(1);
}

std::vector<double> joint_shares_of(const Basis& basis, Eigen::VectorXd weights) {
  if (!(weights.sum() > 0)) weights.setOnes();
  weights /= weights.sum();
  std::vector<double> shares(basis.skeleton.size(), 0.0);
  for (std::uint32_t v = 0; v < basis.mesh.vertex_count(); ++v) {
    for_each_omega(basis.ddm, v, [&](std::uint32_t joint, double omega) { shares[joint] += weights[v] * omega; });
  }
  return shares;
}

Vec3 bone_of(const Skeleton& skeleton, std::uint32_t joint) {
  const Vec3 own = bind_place(skeleton, joint);
  Vec3 sum{0, 0, 0};
  double children = 0;
  for (std::uint32_t other = 0; other < skeleton.size(); ++other) {
    if (skeleton.joints[other].parent != static_cast<int>(joint)) continue;
    sum = sum + (bind_place(skeleton, other) - own);
    ++children;
  }
  if (children > 0) return (1 / children) * sum;
  const int parent = skeleton.joints[joint].parent;
  return parent < 0 ? sum : own - bind_place(skeleton, static_cast<std::uint32_t>(parent));
}

Torso find_torso(const Basis& basis, const std::string& place) {
  const std::vector<std::optional<JointRole>> roles = joint_roles(named_joints(basis.skeleton));
  const auto find = [&](BodyPart part, BodySide side) {
    for (std::size_t j = 0; j < roles.size(); ++j) {
      if (roles[j] == JointRole{part, side, 0}) return static_cast<int>(j);
    }
    return -1;
  };
  const int hips = find(BodyPart::hips, BodySide::middle), neck = find(BodyPart::neck, BodySide::middle),
            left = find(BodyPart::upper_arm, BodySide::left), right = find(BodyPart::upper_arm, BodySide::right);
  const std::pair<int, const char*> needed[] = {
      {hips, "hips"}, {neck, "neck"}, {left, "left upper arm"}, {right, "right upper arm"}};
  for (const auto& [joint, name] : needed) {
    if (joint >= 0) continue;
    throw Error(ErrorKind::mismatch, place, ": no joint of the skeleton is known by its name as the ", name,
                "; hips, neck and both upper arms say where the trunk is");
  }
  const std::vector<Affine> joints = posed_joints(basis.skeleton, bind_pose(basis.skeleton).joints);
  const auto at = [&](int joint) {
    const auto& m = joints[static_cast<std::size_t>(joint)].m;
    return Eigen::Vector3d(m[0][3], m[1][3], m[2][3]);
  };
  Torso torso;
  torso.hips = at(hips);
  torso.length = (at(neck) - at(hips)).norm();
  const Eigen::Vector3d across = at(left) - at(right);
  torso.up = (at(neck) - at(hips)) / torso.length;
  torso.left = (across - across.dot(torso.up) * torso.up).normalized();
  torso.front = torso.left.cross(torso.up);
  if (!(torso.length > 0) || !torso.front.allFinite() || !(torso.front.norm() > 0.5)) {
    throw Error(ErrorKind::mismatch, place, ": hips, neck and upper arms lie on one line: that is no trunk");
  }
  torso.clavicles = {find(BodyPart::clavicle, BodySide::left), find(BodyPart::clavicle, BodySide::right)};
  torso.share = held_by(basis, trunk_joints(basis.skeleton, roles));
  return torso;
}

}  // namespace bodyopt::trainer
