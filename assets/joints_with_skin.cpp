#include "assets/joints_with_skin.h"

#include <algorithm>

namespace bodyopt {
namespace {

constexpr double kSharesSkin = 0.05;  // of a vertex: less is a trace

std::vector<int> have_skin(const Character& character) {
  std::vector<int> have(character.skeleton.size(), 0);
  for (const auto& weights : character.weights) {
    for (const JointWeight& weight : weights) {
      if (weight.weight > kSharesSkin) have[weight.joint] = 1;
    }
  }
  return have;
}

}  // namespace

std::vector<int> joints_with_skin(const Character& character) {
  std::vector<int> with_skin = have_skin(character);
  for (std::size_t j = with_skin.size(); j-- > 0;) {  // parents come before children
    const int parent = character.skeleton.joints[j].parent;
    if (parent >= 0) with_skin[static_cast<std::size_t>(parent)] += with_skin[j];
  }
  return with_skin;
}

std::vector<bool> joints_of_all_skin(const Character& character) {
  const std::vector<int> have = have_skin(character);
  const auto all = std::count(have.begin(), have.end(), 1);
  std::vector<bool> result;
  for (const int count : joints_with_skin(character)) result.push_back(all > 0 && count == all);
  return result;
}

std::vector<std::uint32_t> joints_that_bend(const Character& character) {
  const std::vector<bool> of_all_skin = joints_of_all_skin(character);
  std::vector<std::uint32_t> bending;
  for (std::uint32_t j = 0; j < of_all_skin.size(); ++j) {
    if (character.skeleton.joints[j].parent >= 0 && !of_all_skin[j]) bending.push_back(j);
  }
  return bending;
}

}  // namespace bodyopt
