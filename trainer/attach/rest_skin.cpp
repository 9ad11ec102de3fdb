#include "trainer/attach/rest_skin.h"

#include <bit>

#include "geometry/extent.h"
#include "geometry/table_rows.h"
#include "geometry/vertex_normals.h"

namespace bodyopt {

RestSkin::RestSkin(const Basis& basis)
    : skeleton_(basis.skeleton),
      ddm_(basis.ddm),
      vertices_(rows_of(basis.mesh.rest)),
      triangles_(rows_of(basis.mesh.triangles)),
      diagonal_(box_diagonal(vertices_)),
      search_(vertices_, triangles_) {
  normals_ = vertex_normals(vertices_, triangles_);
  normals_.rowwise().normalize();
}

SkinPoint RestSkin::facing(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
  const SkinPoint nearest = search_(point), facing = search_.facing(point, normal);
  if (facing.triangle < 0) return nearest;
  return (facing.position - point).norm() <= 2 * (nearest.position - point).norm() ? facing : nearest;
}

Eigen::Vector3d RestSkin::normal(const SkinPoint& point) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Eigen::Index k = 0; k < 3; ++k) {
    sum += point.weights[k] * normals_.row(point.vertices[static_cast<std::size_t>(k)]).transpose();
  }
  return sum.normalized();
}

std::vector<double> RestSkin::joint_weights(const SkinPoint& point) const {
  std::vector<double> weights(skeleton_.size(), 0.0);
  for (Eigen::Index k = 0; k < 3; ++k) {
    const std::uint32_t vertex = point.vertices[static_cast<std::size_t>(k)];
    const std::uint32_t block = vertex / kBlockSize, lane = vertex % kBlockSize;
    for (std::uint32_t e = ddm_.block_begin[block]; e < ddm_.block_begin[block + 1]; ++e) {
      const std::uint32_t omega = ddm_.moments[(std::size_t{e} * kMomentWords + 6) * kBlockSize + lane];
      weights[ddm_.block_joints[e]] += point.weights[k] * static_cast<double>(std::bit_cast<float>(omega));
    }
  }
  return weights;
}

}  // namespace bodyopt
