#include "trainer/train/unpose.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <bit>

#include "runtime/cpu/half.h"
#include "trainer/train/blend_matrix.h"

namespace bodyopt {
namespace {

struct Frame {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
};

// argmax of tr(R^T Q) over rotations.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& q) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(q, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
  return u * svd.matrixV().transpose();
}

Frame vertex_frame(const DdmTable& ddm, std::uint32_t vertex, const std::vector<BlendMatrix>& skinning) {
  const DdmVertex& v = ddm.vertices[vertex];
  const Eigen::Vector4d centre(v.centre_x, v.centre_y, v.centre_z, 1);
  const Eigen::Vector3d base = skinning[v.base_joint] * centre;
  Eigen::Matrix3d q = Eigen::Matrix3d::Zero();
  Eigen::Vector3d translation = base;
  const std::uint32_t block = vertex / kBlockSize;
  for (std::uint32_t e = ddm.block_begin[block]; e < ddm.block_begin[block + 1]; ++e) {
    const std::uint32_t* word = ddm.moments.data() + std::size_t{e} * kMomentWords * kBlockSize + vertex % kBlockSize;
    const auto number = [&](std::uint32_t k) { return double{std::bit_cast<float>(word[k * kBlockSize])}; };
    const double xx = half_low(word[0]), xy = half_high(word[0]), xz = half_low(word[kBlockSize]),
                 yy = half_high(word[kBlockSize]), yz = half_low(word[2 * kBlockSize]),
                 zz = half_high(word[2 * kBlockSize]);
    Eigen::Matrix3d second;
    second << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    const Eigen::Vector3d first(number(3), number(4), number(5));
    const BlendMatrix& m = skinning[ddm.block_joints[e]];
    const Eigen::Vector3d arm = m * centre - base;
    q += m.leftCols<3>() * second + arm * first.transpose();
    translation += number(6) * arm + double{v.radius2} * (m.leftCols<3>() * first);
  }
  return {nearest_rotation(q), translation};
}

}  // namespace

Positions unpose_ddm(const Basis& basis, const Pose& pose, const Positions& shape) {
  const std::vector<BlendMatrix> skinning = blend_matrices(basis.skeleton, pose);
  Positions result(shape.rows(), 3);
  for (Eigen::Index v = 0; v < shape.rows(); ++v) {
    const Frame frame = vertex_frame(basis.ddm, static_cast<std::uint32_t>(v), skinning);
    const DdmVertex& vertex = basis.ddm.vertices[static_cast<std::size_t>(v)];
    const Eigen::Vector3d offset(vertex.offset_x, vertex.offset_y, vertex.offset_z);
    const Eigen::Vector3d delta = frame.rotation.transpose() * (shape.row(v).transpose() - frame.translation) - offset;
    result.row(v) = delta.transpose();
  }
  return result;
}

Positions unpose_linear(const Character& character, const Pose& pose, const Positions& shape) {
  const std::vector<BlendMatrix> skinning = blend_matrices(character.skeleton, pose);
  Positions result = Positions::Zero(shape.rows(), 3);
  for (Eigen::Index v = 0; v < shape.rows(); ++v) {
    const BlendMatrix m = blended(skinning, character.weights[static_cast<std::size_t>(v)]);
    const Eigen::FullPivLU<Eigen::Matrix3d> linear(m.leftCols<3>());
    if (!linear.isInvertible()) continue;
    const Eigen::Vector3d rest = linear.solve(shape.row(v).transpose() - m.col(3));
    result.row(v) = rest.transpose() - character.vertices.row(v);
  }
  return result;
}

}  // namespace bodyopt
