#include "assets/characters/joints_with_skin.h"

#include <algorithm>

#include "runtime/core/transformed.h"

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

constexpr double kFewestVertices = 40;

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
  const auto all = std::ranges::count(have, 1);
  return transformed(joints_with_skin(character), [&](const int count) { return all > 0 && count == all; });
}

std::vector<std::uint32_t> joints_that_bend(const Character& character) {
  const std::vector<bool> of_all_skin = joints_of_all_skin(character);
  std::vector<std::uint32_t> bending;
  for (std::uint32_t j = 0; j < of_all_skin.size(); ++j) {
    if (character.skeleton.joints[j].parent >= 0 && !of_all_skin[j]) bending.push_back(j);
  }
  return bending;
}

std::vector<RegionWeights> joint_regions(const Character& character) {
  const std::vector<Joint>& joints = character.skeleton.joints;
  const Eigen::Index vertices = character.vertices.rows();
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(vertices, static_cast<Eigen::Index>(joints.size()));
  for (Eigen::Index v = 0; v < vertices; ++v) {
    for (const JointWeight& weight : character.weights[static_cast<std::size_t>(v)]) {
      weights(v, weight.joint) += weight.weight;
    }
  }
  for (std::size_t j = joints.size(); j-- > 0;) {  // parents come before children
    const auto column = static_cast<Eigen::Index>(j);
    if (joints[j].parent < 0 || weights.col(column).sum() >= kFewestVertices) continue;
    weights.col(joints[j].parent) += weights.col(column);
    weights.col(column).setZero();
  }
  std::vector<RegionWeights> regions;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (weights.col(static_cast<Eigen::Index>(j)).maxCoeff() < kNegligibleRegionWeight) continue;
    regions.push_back(region_of(joints[j].name, weights.col(static_cast<Eigen::Index>(j))));
  }
  drop_negligible(regions);
  scale_to_one(regions, vertices);
  return regions;
}

}  // namespace bodyopt
