#include "trainer/train/skinning/unpose.h"

#include <Eigen/LU>
#include <string>

#include "runtime/core/error.h"
#include "runtime/cpu/ddm_frames.h"
#include "runtime/host/rig.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::trainer {

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

std::vector<VertexPlacement> ddm_placements(const Basis& basis, const Pose& pose,
                                            std::span<const std::uint32_t> vertices) {
  using RowMajor3 = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;
  const RigFrame rig = pose_rig(basis.skeleton, pose);
  const Eigen::Vector3d root = Eigen::Vector3f(rig.origin).cast<double>();
  std::vector<float> frames(12 * vertices.size());
  cpu::vertex_frames(basis.ddm, vertices, rig.skinning.data(), frames);
  std::vector<VertexPlacement> placements(vertices.size());
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const float *r = &frames[12 * k], *t = r + 9;
    const DdmVertex& v = basis.ddm.vertices[vertices[k]];
    placements[k] = {Eigen::Map<const RowMajor3>(r).cast<double>(),
                     root + Eigen::Map<const Eigen::Vector3f>(t).cast<double>(),
                     Eigen::Vector3f(v.offset_x, v.offset_y, v.offset_z).cast<double>()};
  }
  return placements;
}

std::vector<VertexPlacement> ddm_placements(const Basis& basis, const Pose& pose) {
  return ddm_placements(basis, pose, all_vertices(basis.mesh.vertex_count()));
}

Positions unpose_ddm(const Basis& basis, const Pose& pose, const Positions& shape,
                     std::span<const std::uint32_t> vertices) {
  const std::vector<VertexPlacement> placements = ddm_placements(basis, pose, vertices);
  Positions result(shape.rows(), 3);
  for (Eigen::Index k = 0; k < shape.rows(); ++k) {
    result.row(k) = placements[static_cast<std::size_t>(k)].unposed(shape.row(k));
  }
  return result;
}

Positions unpose_linear(const Character& character, const Pose& pose, const Positions& shape,
                        std::span<const std::uint32_t> vertices) {
  const std::vector<BlendMatrix> skinning = blend_matrices(character.skeleton, pose);
  Positions result = Positions::Zero(shape.rows(), 3);
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const BlendMatrix m = blended(skinning, character.weights[vertices[k]]);
    const Eigen::FullPivLU<Eigen::Matrix3d> linear(m.leftCols<3>());
    if (!linear.isInvertible()) continue;
    const Eigen::Vector3d rest = linear.solve(shape.row(row).transpose() - m.col(3));
    result.row(row) = rest.transpose() - character.vertices.row(vertices[k]);
  }
  return result;
}

Positions unpose_ddm(const Basis& basis, const Pose& pose, const Positions& shape) {
  return unpose_ddm(basis, pose, shape, all_vertices(shape.rows()));
}

Positions unpose_linear(const Character& character, const Pose& pose, const Positions& shape) {
  return unpose_linear(character, pose, shape, all_vertices(shape.rows()));
}

}  // namespace bodyopt::trainer
