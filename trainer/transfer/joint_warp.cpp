#include "trainer/transfer/joint_warp.h"

#include "geometry/table_rows.h"
#include "runtime/basis/joint_omegas.h"
#include "runtime/host/rig.h"

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

// Per joint of the source, the lengths of its bones to the nearest matched joints below: target's over source's; 0
// where it has none.
std::vector<double> bone_ratios(const Skeleton& source, const SkeletonMatch& match, const Positions& from,
                                const Positions& to) {
  std::vector<double> own(source.size(), 0.0), other = own;
  for (std::size_t j = 0; j < source.size(); ++j) {
    const int above = matched_at_or_above(source, match.target_joint, source.joints[j].parent);
    if (above < 0 || match.target_joint[j] < 0) continue;
    const auto a = static_cast<std::size_t>(above);
    own[a] += (from.row(static_cast<Eigen::Index>(j)) - from.row(above)).norm();
    other[a] += (to.row(match.target_joint[j]) - to.row(match.target_joint[a])).norm();
  }
  for (std::size_t j = 0; j < own.size(); ++j) own[j] = own[j] > 0 ? other[j] / own[j] : 0;
  return own;
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

std::vector<JointWarp> joint_warps(const Basis& source, const Basis& target, const SkeletonMatch& match) {
  const Positions from = joint_places(source.skeleton, bind_pose(source.skeleton)),
                  to = joint_places(target.skeleton, match.common);
  const std::vector<double> ratios = bone_ratios(source.skeleton, match, from, to);
  std::vector<JointWarp> warps(source.skeleton.size());
  for (std::size_t j = 0; j < warps.size(); ++j) {
    const int parent = source.skeleton.joints[j].parent, other = match.target_joint[j];
    if (other < 0 && parent >= 0) {
      warps[j] = warps[static_cast<std::size_t>(parent)];
      continue;
    }
    const double inherited = parent >= 0 ? warps[static_cast<std::size_t>(parent)].size : match.size;
    warps[j] = {from.row(static_cast<Eigen::Index>(j)), to.row(std::max(other, 0)),
                ratios[j] > 0 ? ratios[j] : inherited};
  }
  return warps;
}

Positions warped_by_joints(const Basis& source, const Basis& target, const SkeletonMatch& match) {
  const std::vector<JointWarp> warps = joint_warps(source, target, match);
  const JointShares shares = source_joint_shares(source, match);
  const Positions rest = rows_of(source.mesh.rest);
  Positions result = Positions::Zero(rest.rows(), 3);
  for (Eigen::Index j = 0; j < shares.cols(); ++j) {
    const JointWarp& warp = warps[static_cast<std::size_t>(j)];
    for (Eigen::Index v = 0; v < rest.rows(); ++v) {
      if (shares(v, j) > 0) result.row(v) += shares(v, j) * (warp.to + warp.size * (rest.row(v) - warp.from));
    }
  }
  return result;
}

}  // namespace bodyopt
