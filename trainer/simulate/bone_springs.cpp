#include "trainer/simulate/bone_springs.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace bodyopt::trainer {
namespace {

constexpr double kLargestHuman = 0.15;  // cubic metres; a cage that sticks out of its skin is larger

Eigen::Vector3d apply(const Affine& transform, const Eigen::Vector3d& point, double share = 1) {
  Eigen::Vector3d result;
  for (int i = 0; i < 3; ++i) {
    const double* row = transform.m[i];
    result[i] = row[0] * point[0] + row[1] * point[1] + row[2] * point[2] + row[3] * share;
  }
  return result;
}

}  // namespace

double bone_stiffness(const Materials& materials, const TetMesh& mesh) {
  return materials.bone_springs * std::min(1.0, std::pow(kLargestHuman / volume(mesh), 2.0 / 3));
}

BoneSprings::BoneSprings(const TetMesh& mesh, const std::vector<BonePart>& bones, double k, std::size_t joint_count)
    : rest_(mesh.nodes),
      stiffness_(mesh.nodes.rows(), mesh.nodes.rows()),
      by_joint_(NodeWeights::Zero(mesh.nodes.rows(), static_cast<Eigen::Index>(joint_count))),
      main_joint_(static_cast<std::size_t>(mesh.nodes.rows()), -1) {
  std::vector<Eigen::Triplet<double>> entries;
  std::map<std::pair<int, int>, Moment> moments;
  for (const BonePart& bone : bones) {
    for (int a = 0; a < 4; ++a) {
      const int node = mesh.tets(bone.tet, a);
      Moment& moment =
          moments.try_emplace({node, bone.joint}, Moment{node, bone.joint, 0, Eigen::Vector3d::Zero()}).first->second;
      for (int b = 0; b < 4; ++b) {
        const int other = mesh.tets(bone.tet, b);
        const double stiffness = k * bone.moments(a, b);
        moment.sum += stiffness;
        moment.first += stiffness * mesh.nodes.row(other).transpose();
        by_joint_(node, bone.joint) += stiffness;
        entries.emplace_back(node, other, stiffness);
      }
    }
  }
  stiffness_.setFromTriplets(entries.begin(), entries.end());
  for (const auto& [key, moment] : moments) {
    moments_.push_back(moment);
    int& main = main_joint_[static_cast<std::size_t>(moment.node)];
    if (main < 0 || moment.sum > by_joint_(moment.node, main)) main = moment.joint;
  }
}

SpringPose BoneSprings::pose(std::span<const Affine> skinning) const {
  SpringPose result{Positions::Zero(rest_.rows(), 3), Positions::Zero(rest_.rows(), 3)};
  for (std::size_t n = 0; n < main_joint_.size(); ++n) {
    if (main_joint_[n] < 0) continue;
    const auto row = static_cast<Eigen::Index>(n);
    result.base.row(row) = apply(skinning[static_cast<std::size_t>(main_joint_[n])], rest_.row(row));
  }
  for (const Moment& moment : moments_) {
    result.pull.row(moment.node) += apply(skinning[static_cast<std::size_t>(moment.joint)], moment.first, moment.sum);
  }
  result.pull -= stiffness_ * result.base;
  return result;
}

double BoneSprings::add_gradient(const SpringPose& pose, const Positions& nodes, Positions& gradient) const {
  const Positions offset = nodes - pose.base;
  const Positions force = stiffness_ * offset;
  gradient += force - pose.pull;
  return offset.cwiseProduct(0.5 * force - pose.pull).sum();
}

}  // namespace bodyopt::trainer
