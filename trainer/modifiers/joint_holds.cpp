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

}  // namespace bodyopt
