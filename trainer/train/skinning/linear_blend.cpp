#include "trainer/train/skinning/linear_blend.h"

#include <string>

#include "runtime/core/error.h"
#include "runtime/host/rig.h"

namespace bodyopt {

std::vector<BlendMatrix> blend_matrices(const Skeleton& skeleton, const Pose& pose) {
  if (pose.joints.size() != skeleton.size()) {
    throw Error(ErrorKind::mismatch, "a pose of " + std::to_string(pose.joints.size()) +
                                         " joints was given to a skeleton of " + std::to_string(skeleton.size()) +
                                         ": it was made for another skeleton");
  }
  std::vector<BlendMatrix> matrices;
  for (const Affine& affine : skinning_matrices(skeleton, pose.joints)) {
    matrices.emplace_back(Eigen::Map<const BlendMatrix>(&affine.m[0][0]));
  }
  return matrices;
}

BlendMatrix blended(const std::vector<BlendMatrix>& skinning, const std::vector<JointWeight>& weights) {
  BlendMatrix sum = BlendMatrix::Zero();
  for (const JointWeight& w : weights) sum += w.weight * skinning[w.joint];
  return sum;
}

Positions skin_linear(const Character& character, const Pose& pose) {
  const std::vector<BlendMatrix> skinning = blend_matrices(character.skeleton, pose);
  Positions result(character.vertices.rows(), 3);
  for (Eigen::Index v = 0; v < result.rows(); ++v) {
    const Eigen::Vector4d rest(character.vertices(v, 0), character.vertices(v, 1), character.vertices(v, 2), 1);
    result.row(v) = (blended(skinning, character.weights[static_cast<std::size_t>(v)]) * rest).transpose();
  }
  return result;
}

}  // namespace bodyopt
