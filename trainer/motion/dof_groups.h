// Which degrees of freedom move the same flesh.
#pragma once

#include <array>
#include <set>
#include <vector>

#include "trainer/motion/joint_limits.h"

namespace bodyopt {

using DofGroup = std::vector<std::size_t>;  // indices of degrees of freedom, ascending

// Degrees of freedom that turn a joint in common, directly or through others, are one group.
std::vector<DofGroup> dof_groups(const JointLimits& limits);

// Pairs that turn the same joint, or a joint and its parent.
std::vector<std::array<std::size_t, 2>> dof_pairs(const JointLimits& limits, const Skeleton& skeleton);

// The joints that move joint `a` relative to joint `b`: from both up to, and without, their common ancestor.
std::set<std::uint32_t> joints_between(const Skeleton& skeleton, std::uint32_t a, std::uint32_t b);

}  // namespace bodyopt
