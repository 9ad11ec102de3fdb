#include "trainer/transfer/joint_warp.h"

#include "geometry/table_rows.h"
#include "runtime/host/rig.h"
#include "trainer/transfer/joint_shares.h"

namespace bodyopt {
namespace {

Positions joint_places(const Skeleton& skeleton, const Pose& pose) {
  const std::vector<Affine> world = posed_joints(skeleton, pose.joints);
  Positions places(static_cast<Eigen::Index>(world.size()), 3);
  for (std::size_t j = 0; j < world.size(); ++j) {
    for (int i = 0; i < 3; ++i) places(static_cast<Eigen::Index>(j), i) = world[j].m[i][3];
  }
  return places;
}

// Per joint of the source, the lengths of its bones to the nearest matched joints below: target's over source's; 0
// where it has none.
std::vector<double> bone_ratios(const Skeleton& source, const SkeletonMatch& match, const Positions& from,
                                const Positions& to) {
  std::vector<double> own(source.size(), 0.0), other = own;
  for (std::size_t j = 0; j < source.size(); ++j) {
    int above = source.joints[j].parent;
    while (above >= 0 && match.target_joint[static_cast<std::size_t>(above)] < 0) {
      above = source.joints[static_cast<std::size_t>(above)].parent;
    }
    if (above < 0 || match.target_joint[j] < 0) continue;
    const auto a = static_cast<std::size_t>(above);
    own[a] += (from.row(static_cast<Eigen::Index>(j)) - from.row(above)).norm();
    other[a] += (to.row(match.target_joint[j]) - to.row(match.target_joint[a])).norm();
  }
  for (std::size_t j = 0; j < own.size(); ++j) own[j] = own[j] > 0 ? other[j] / own[j] : 0;
  return own;
}

}  // namespace

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
