#include "assets/caches/bound_skin.h"

#include <Eigen/Dense>
#include <algorithm>

#include "base/parallel.h"
#include "runtime/host/rig.h"

namespace bodyopt {
namespace {

using Blended = Eigen::Matrix<double, 3, 4>;

Blended blend(const std::vector<Affine>& joints, const std::vector<JointWeight>& weights) {
  Blended sum = Blended::Zero();
  for (const JointWeight& weight : weights) {
    const Affine& joint = joints[static_cast<std::size_t>(weight.joint)];
    sum += weight.weight * Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(&joint.m[0][0]);
  }
  return sum;
}

// Solves linear x = residual by Tikhonov's least squares, and once more for what that leaves.
Eigen::Vector3d solve_damped(const Eigen::Matrix3d& linear, const Eigen::Vector3d& residual) {
  constexpr double kDamping = 1e-4;  // of the mean squared stretch
  const double damping = std::max(1e-30, kDamping * linear.squaredNorm() / 3);
  const Eigen::Matrix3d normal = linear.transpose() * linear + damping * Eigen::Matrix3d::Identity(),
                        solve = normal.inverse() * linear.transpose();
  const Eigen::Vector3d first = solve * residual;
  return first + solve * (residual - linear * first);
}

}  // namespace

std::vector<float> blend_shape(const BoundSkin& skin, int frame, std::span<const float> shape) {
  const Character& character = skin.character;
  const Pose& pose = skin.clip.poses[static_cast<std::size_t>(frame - skin.clip.first_frame)];
  const std::vector<Affine> joints = skinning_matrices(character.skeleton, pose.joints);
  std::vector<float> offsets(shape.size());
  parallel_for(character.output_vertex.size(), [&](std::size_t o) {
    const std::uint32_t vertex = character.output_vertex[o];
    const Blended blended = blend(joints, character.weights[vertex]);
    const Eigen::Vector3d rest = character.vertices.row(vertex).transpose(),
                          wanted = Eigen::Map<const Eigen::Vector3f>(&shape[3 * o]).cast<double>();
    const Eigen::Matrix3d linear = blended.leftCols<3>();
    const Eigen::Vector3d offset = solve_damped(linear, wanted - linear * rest - blended.col(3));
    for (std::size_t i = 0; i < 3; ++i) offsets[3 * o + i] = static_cast<float>(offset(static_cast<Eigen::Index>(i)));
  });
  return offsets;
}

}  // namespace bodyopt
