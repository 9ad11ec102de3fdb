#include "assets/joint_regions.h"

namespace bodyopt {
namespace {

constexpr double kFewestVertices = 40;

RegionWeights region_of(const std::string& name, const Eigen::VectorXd& weights) {
  RegionWeights region{name, {}, {}};
  for (Eigen::Index v = 0; v < weights.size(); ++v) {
    if (!(weights[v] > 0)) continue;
    region.vertices.push_back(static_cast<std::uint32_t>(v));
    region.weights.push_back(weights[v]);
  }
  return region;
}

}  // namespace

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
