#include "trainer/modifiers/joint_holds.h"

#include <bit>

namespace bodyopt {
namespace {

// visit(vertex, joint, omega) of all that the table holds.
template <typename Visit>
void for_each_hold(const Basis& basis, const Visit& visit) {
  const DdmTable& ddm = basis.ddm;
  for (std::uint32_t v = 0; v < basis.mesh.vertex_count(); ++v) {
    const std::uint32_t block = v / kBlockSize, lane = v % kBlockSize;
    for (std::uint32_t e = ddm.block_begin[block]; e < ddm.block_begin[block + 1]; ++e) {
      const std::uint32_t omega = ddm.moments[(e * kMomentWords + kMomentWords - 1) * kBlockSize + lane];
      visit(v, ddm.block_joints[e], static_cast<double>(std::bit_cast<float>(omega)));
    }
  }
}

}  // namespace

Eigen::VectorXd held_by(const Basis& basis, const std::vector<char>& chosen) {
  Eigen::VectorXd share = Eigen::VectorXd::Zero(basis.mesh.vertex_count());
  for_each_hold(basis, [&](std::uint32_t v, std::uint32_t joint, double omega) {
    if (chosen[joint]) share[v] += omega;
  });
  return share.cwiseMax(0).cwiseMin(1);
}

std::vector<double> joint_shares_of(const Basis& basis, Eigen::VectorXd weights) {
  if (!(weights.sum() > 0)) weights.setOnes();
  weights /= weights.sum();
  std::vector<double> shares(basis.skeleton.size(), 0.0);
  for_each_hold(basis,
                [&](std::uint32_t v, std::uint32_t joint, double omega) { shares[joint] += weights[v] * omega; });
  return shares;
}

}  // namespace bodyopt
