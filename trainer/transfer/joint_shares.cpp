#include "trainer/transfer/joint_shares.h"

#include "runtime/basis/joint_omegas.h"

namespace bodyopt {
namespace {

// Column of every joint of a skeleton: `column` of itself, or of the nearest joint above that has one; else the first.
std::vector<Eigen::Index> columns_of(const Skeleton& skeleton, const std::vector<int>& column) {
  std::vector<Eigen::Index> result(skeleton.size(), 0);
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    if (column[j] >= 0) {
      result[j] = column[j];
    } else if (parent >= 0) {
      result[j] = result[static_cast<std::size_t>(parent)];
    }
  }
  return result;
}

JointShares shares_of(const Basis& basis, const std::vector<Eigen::Index>& columns, Eigen::Index count) {
  JointShares shares = JointShares::Zero(basis.mesh.vertex_count(), count);
  for (std::uint32_t v = 0; v < basis.mesh.vertex_count(); ++v) {
    for_each_omega(basis.ddm, v, [&](std::uint32_t joint, double omega) { shares(v, columns[joint]) += omega; });
  }
  return shares;
}

}  // namespace

JointShares source_joint_shares(const Basis& source, const SkeletonMatch& match) {
  std::vector<int> column(match.target_joint.size(), -1);
  for (std::size_t j = 0; j < column.size(); ++j) {
    if (match.target_joint[j] >= 0) column[j] = static_cast<int>(j);
  }
  return shares_of(source, columns_of(source.skeleton, column), static_cast<Eigen::Index>(source.skeleton.size()));
}

JointShares target_joint_shares(const Basis& target, const SkeletonMatch& match) {
  return shares_of(target, columns_of(target.skeleton, match.source_joint),
                   static_cast<Eigen::Index>(match.target_joint.size()));
}

Eigen::VectorXd share_of_matched(const Basis& basis, const std::vector<int>& match) {
  Eigen::VectorXd shares = Eigen::VectorXd::Zero(basis.mesh.vertex_count());
  for (std::uint32_t v = 0; v < basis.mesh.vertex_count(); ++v) {
    for_each_omega(basis.ddm, v, [&](std::uint32_t joint, double omega) {
      if (match[joint] >= 0) shares[v] += omega;
    });
  }
  return shares;
}

}  // namespace bodyopt
