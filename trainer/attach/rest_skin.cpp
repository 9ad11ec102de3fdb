#include "trainer/attach/rest_skin.h"

#include "geometry/extent.h"
#include "geometry/table_rows.h"
#include "geometry/vertex_normals.h"
#include "runtime/basis/joint_omegas.h"

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
    for_each_omega(ddm_, point.vertices[static_cast<std::size_t>(k)],
                   [&](std::uint32_t joint, double omega) { weights[joint] += point.weights[k] * omega; });
  }
  return weights;
}

}  // namespace bodyopt
