// Where the joints alone would bring the source's body on the target.
#pragma once

#include <vector>

#include "geometry/mesh.h"
#include "runtime/basis/basis.h"
#include "trainer/transfer/match_skeletons.h"

namespace bodyopt {

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
