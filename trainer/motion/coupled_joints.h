// Joints whose turns a motion does not tell apart.
#pragma once

#include <string>
#include <vector>

#include "runtime/basis/skeleton.h"

namespace bodyopt {

// A joint and its parent that turn together: what one of them moves cannot be learned from poses in which the other
// does not stay where it is.
struct CoupledJoints {
  std::uint32_t joint, parent;
  double correlation;  // the largest canonical one (Hotelling 1936) of their turns away from the bind pose, 0 to 1
};

// Those above 0.97 (of a turn of 45 degrees, 11 or less are the joint's own), in joint order; joints that turn by less
// than 3 degrees, root mean square, are left out.
std::vector<CoupledJoints> coupled_joints(const Skeleton& skeleton, const std::vector<Pose>& poses);

// "these joints turn only together, ...: 'Neck1' with 'Neck', ...". Empty for none.
std::string describe(const std::vector<CoupledJoints>& coupled, const Skeleton& skeleton);

}  // namespace bodyopt
