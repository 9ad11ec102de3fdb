// Lays the source's rest skin onto the target's.
#pragma once

#include "trainer/transfer/correspondence.h"
#include "trainer/transfer/joint_shares.h"

namespace bodyopt {

// V x 3, runtime order of the source. `goal`: the target's skin in the common pose, runtime order. See match_skins().
// Shows progress; throws Error(interrupted) after SIGINT.
Positions register_skin(const Basis& source, const Basis& target, const Positions& goal,
                        const JointShares& source_shares, const JointShares& target_shares, const SkeletonMatch& match,
                        const std::vector<SkinMarker>& markers);

}  // namespace bodyopt
