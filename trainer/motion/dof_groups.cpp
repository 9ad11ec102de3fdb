#include "trainer/motion/dof_groups.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <numeric>

namespace bodyopt {
namespace {

template <class Related>
bool any_turns(const DegreeOfFreedom& a, const DegreeOfFreedom& b, Related related) {
  return std::any_of(a.turns.begin(), a.turns.end(), [&](const JointTurn& s) {
    return std::any_of(b.turns.begin(), b.turns.end(), [&](const JointTurn& t) { return related(s.joint, t.joint); });
  });
}

}  // namespace

std::vector<DofGroup> dof_groups(const JointLimits& limits) {
  const std::size_t count = limits.dofs.size();
  std::vector<std::size_t> group_of(count);
  std::iota(group_of.begin(), group_of.end(), std::size_t{0});
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = a + 1; b < count; ++b) {
      if (!any_turns(limits.dofs[a], limits.dofs[b], std::equal_to<>())) continue;
      std::replace(group_of.begin(), group_of.end(), std::size_t{group_of[b]}, std::size_t{group_of[a]});
    }
  }
  std::vector<DofGroup> groups;
  for (std::size_t name = 0; name < count; ++name) {
    DofGroup group;
    for (std::size_t k = 0; k < count; ++k) {
      if (group_of[k] == name) group.push_back(k);
    }
    if (!group.empty()) groups.push_back(group);
  }
  return groups;
}

std::vector<std::array<std::size_t, 2>> dof_pairs(const JointLimits& limits, const Skeleton& skeleton) {
  const auto neighbours = [&](std::uint32_t a, std::uint32_t b) {
    return a == b || skeleton.joints[a].parent == static_cast<int>(b) ||
           skeleton.joints[b].parent == static_cast<int>(a);
  };
  std::vector<std::array<std::size_t, 2>> pairs;
  for (std::size_t a = 0; a < limits.dofs.size(); ++a) {
    for (std::size_t b = a + 1; b < limits.dofs.size(); ++b) {
      if (any_turns(limits.dofs[a], limits.dofs[b], neighbours)) pairs.push_back({a, b});
    }
  }
  return pairs;
}

std::set<std::uint32_t> joints_between(const Skeleton& skeleton, std::uint32_t a, std::uint32_t b) {
  const auto chain = [&](std::uint32_t joint) {
    std::set<std::uint32_t> joints;
    for (int j = static_cast<int>(joint); j >= 0; j = skeleton.joints[static_cast<std::size_t>(j)].parent) {
      joints.insert(static_cast<std::uint32_t>(j));
    }
    return joints;
  };
  const std::set<std::uint32_t> up_a = chain(a), up_b = chain(b);
  std::set<std::uint32_t> between;
  std::set_symmetric_difference(up_a.begin(), up_a.end(), up_b.begin(), up_b.end(),
                                std::inserter(between, between.end()));
  return between;
}

}  // namespace bodyopt
