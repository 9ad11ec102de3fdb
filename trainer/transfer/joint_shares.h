// How much of each vertex the joints hold that both characters have.
#pragma once

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

}  // namespace bodyopt
