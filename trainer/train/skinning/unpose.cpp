#include "trainer/train/skinning/unpose.h"

#include <Eigen/LU>
#include <numeric>

#include "runtime/cpu/ddm_frames.h"
#include "runtime/host/rig.h"
#include "trainer/train/skinning/linear_blend.h"

namespace bodyopt {

Positions unpose_ddm(const Basis& basis, const Pose& pose, const Positions& shape,
                     std::span<const std::uint32_t> vertices) {
  using RowMajor3 = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;
  const RigFrame rig = pose_rig(basis.skeleton, pose);
  const Eigen::Vector3d origin = Eigen::Vector3f(rig.origin).cast<double>();
  std::vector<float> frames(12 * vertices.size());
  cpu::vertex_frames(basis.ddm, vertices, rig.skinning.data(), frames);
  Positions result(shape.rows(), 3);
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const float *r = &frames[12 * k], *t = r + 9;
    const DdmVertex& v = basis.ddm.vertices[vertices[k]];
    const auto row = static_cast<Eigen::Index>(k);
    const Eigen::Vector3d moved =
        shape.row(row).transpose() - origin - Eigen::Map<const Eigen::Vector3f>(t).cast<double>();
    result.row(row) = Eigen::Map<const RowMajor3>(r).cast<double>().transpose() * moved -
                      Eigen::Vector3f(v.offset_x, v.offset_y, v.offset_z).cast<double>();
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

namespace {

std::vector<std::uint32_t> all_vertices(Eigen::Index count) {
  std::vector<std::uint32_t> all(static_cast<std::size_t>(count));
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

}  // namespace

Positions unpose_ddm(const Basis& basis, const Pose& pose, const Positions& shape) {
  return unpose_ddm(basis, pose, shape, all_vertices(shape.rows()));
}

Positions unpose_linear(const Character& character, const Pose& pose, const Positions& shape) {
  return unpose_linear(character, pose, shape, all_vertices(shape.rows()));
}

}  // namespace bodyopt
