// Whose skin a fold closes on, as the skeleton tells.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

// J: does the joint carry more than one limb? A limb is a chain of bones longer than a quarter of the longest one from
// a root: an arm, a leg, a tail, no finger.
std::vector<char> trunk_joints(const Skeleton& skeleton);

// J, metres: how far around a fold's joint at rest skin that each joint holds belongs to it. All of `reach` what the
// joint bends, and what is as near along the bones; of the trunk less, and nothing where the limb's joint is far from
// it; nothing of all else: hands are not the groin's.
std::vector<float> fold_reaches(const Skeleton& skeleton, std::uint32_t joint, float reach);

// J: of each joint whether it is `joint` or one below it.
std::vector<char> at_or_below(const Skeleton& skeleton, std::uint32_t joint);

}  // namespace bodyopt
