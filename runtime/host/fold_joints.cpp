#include "runtime/host/fold_joints.h"

#include <algorithm>
#include <limits>

namespace bodyopt {
namespace {

constexpr double kLimb = 0.25;  // of the longest chain's length
// Of a fold's reach: how far its joint is from the trunk at most, along the bones, where the trunk's skin may close on
// the limb's, and how far around the joint that skin stands. An elbow does not fold on the belly, nor an armpit at the
// waist.
constexpr double kFromTrunk = 0.75;
constexpr float kTrunkReach = 0.625f;

std::size_t parent_of(const Skeleton& skeleton, std::size_t joint) {
  return static_cast<std::size_t>(skeleton.joints[joint].parent);
}
// Metres, at rest.
double bone_above(const Skeleton& skeleton, std::size_t joint) {
  return length(bind_place(skeleton, joint) - bind_place(skeleton, parent_of(skeleton, joint)));
}

// J, metres: from joint to joint at rest, along the bones between them; -1 where none lead there.
std::vector<double> ways_along_bones(const Skeleton& skeleton, std::uint32_t joint) {
  std::vector<double> ways(skeleton.size(), -1);
  double up = 0;
  for (int at = static_cast<int>(joint); at >= 0; at = skeleton.joints[static_cast<std::size_t>(at)].parent) {
    const auto j = static_cast<std::size_t>(at);
    ways[j] = up;
    if (skeleton.joints[j].parent >= 0) up += bone_above(skeleton, j);
  }
  for (std::size_t j = 0; j < ways.size(); ++j) {  // parents stand before their children
    if (ways[j] < 0 && skeleton.joints[j].parent >= 0) {
      const double above = ways[parent_of(skeleton, j)];
      if (above >= 0) ways[j] = above + bone_above(skeleton, j);
    }
  }
  return ways;
}

// J, metres: the longest chain of bones from the joint's parent through it; from the joint where it has none.
std::vector<double> chain_lengths(const Skeleton& skeleton) {
  std::vector<double> lengths(skeleton.size(), 0);
  for (std::size_t j = lengths.size(); j-- > 0;) {
    if (skeleton.joints[j].parent < 0) continue;
    lengths[j] += bone_above(skeleton, j);
    double& above = lengths[parent_of(skeleton, j)];
    above = std::max(above, lengths[j]);
  }
  return lengths;
}

// Metres along the bones to the nearest joint of the trunk.
double way_to_trunk(const std::vector<double>& ways, const std::vector<char>& trunk) {
  double least = std::numeric_limits<double>::max();
  for (std::size_t j = 0; j < ways.size(); ++j) {
    if (trunk[j] && ways[j] >= 0) least = std::min(least, ways[j]);
  }
  return least;
}

}  // namespace

std::vector<char> trunk_joints(const Skeleton& skeleton) {
  const std::vector<double> lengths = chain_lengths(skeleton);
  const double shortest = kLimb * std::ranges::max(lengths);
  std::vector<int> limbs(lengths.size(), 0);
  for (std::size_t j = limbs.size(); j-- > 0;) {
    if (skeleton.joints[j].parent < 0 || lengths[j] < shortest) continue;
    limbs[parent_of(skeleton, j)] += std::max(limbs[j], 1);
  }
  std::vector<char> trunk;
  for (const int count : limbs) trunk.push_back(count > 1);
  return trunk;
}

std::vector<float> fold_reaches(const Skeleton& skeleton, std::uint32_t joint, float reach) {
  const std::vector<double> ways = ways_along_bones(skeleton, joint);
  const std::vector<char> trunk = trunk_joints(skeleton);
  const float of_trunk = way_to_trunk(ways, trunk) < kFromTrunk * double{reach} ? kTrunkReach * reach : 0.0f;
  const std::vector<char> below = at_or_below(skeleton, joint);
  std::vector<float> reaches;
  for (std::size_t j = 0; j < ways.size(); ++j) {
    const bool bent = static_cast<int>(j) == skeleton.joints[joint].parent;
    const bool near = bent || (ways[j] >= 0 && ways[j] < double{reach});
    const bool limb_on_trunk = trunk[j] && !trunk[joint] && !bent,
               beyond = below[j] && j != joint && !trunk[joint] && of_trunk > 0;
    reaches.push_back(limb_on_trunk || (beyond && near) ? of_trunk : near ? reach : 0.0f);
  }
  return reaches;
}

std::vector<char> at_or_below(const Skeleton& skeleton, std::uint32_t joint) {
  std::vector<char> found(skeleton.size());
  for (std::size_t j = 0; j < found.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    found[j] = j == joint || (parent >= 0 && found[static_cast<std::size_t>(parent)]);
  }
  return found;
}

}  // namespace bodyopt
