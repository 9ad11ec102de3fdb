// How much of each vertex the joints hold that both characters have, and where they alone would bring the source's
// body.
#pragma once

#include <vector>

#include "geometry/mesh.h"
#include "runtime/basis/basis.h"
#include "trainer/transfer/match_skeletons.h"

namespace bodyopt {

// V x joints of the source: the omegas of Direct Delta Mush, each row summing to 1. Joints that the other does not have
// count as the nearest above them that it has.
using JointShares = Eigen::MatrixXd;

JointShares source_joint_shares(const Basis& source, const SkeletonMatch& match);
JointShares target_joint_shares(const Basis& target, const SkeletonMatch& match);

// V: of each vertex, what joints hold that have a match themselves; `match`: per joint of the basis, -1 for none.
Eigen::VectorXd share_of_matched(const Basis& basis, const std::vector<int>& match);

// x -> to + size (x - from), from the source's rest to the common pose, metres.
struct JointWarp {
  Eigen::RowVector3d from, to;
  double size = 1;
};

// Per joint of the source, scaled as its bones are on the mean, or as the joint above, or as the whole body. A joint
// without a match goes with the one above.
std::vector<JointWarp> joint_warps(const Basis& source, const Basis& target, const SkeletonMatch& match);

// The source's rest skin (V x 3, runtime order), every joint moving its share.
Positions warped_by_joints(const Basis& source, const Basis& target, const SkeletonMatch& match);

}  // namespace bodyopt
