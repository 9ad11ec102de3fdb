#include "trainer/modifiers/joint_holds.h"

#include "runtime/basis/joint_omegas.h"

namespace bodyopt {

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

}  // namespace bodyopt
