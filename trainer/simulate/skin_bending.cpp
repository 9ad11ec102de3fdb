#include "trainer/simulate/skin_bending.h"

#include "geometry/surface_distance.h"

namespace bodyopt::trainer {

SkinBending::SkinBending(const Positions& vertices, const Triangles& triangles, Eigen::Index node_count,
                         const Materials& materials)
    : laplacian_(cotangent_laplacian(vertices, triangles)),
      weight_(materials.skin_bending * lumped_areas(vertices, triangles).cwiseInverse()),
      rest_curvature_(laplacian_ * vertices),
      stiffness_(laplacian_.transpose() * weight_.asDiagonal() * laplacian_) {
  stiffness_.conservativeResize(node_count, node_count);
}

Positions SkinBending::curvature(const std::vector<Quat>& rotation) const {
  Positions result(rest_curvature_.rows(), 3);
  for (Eigen::Index v = 0; v < result.rows(); ++v) {
    const Vec3 rest{rest_curvature_(v, 0), rest_curvature_(v, 1), rest_curvature_(v, 2)};
    const Vec3 turned = rotate(rotation[static_cast<std::size_t>(v)], rest);
    result.row(v) << turned[0], turned[1], turned[2];
  }
  return result;
}

double SkinBending::add_gradient(const Positions& curvature, const Positions& nodes, Positions& gradient) const {
  const Eigen::Index skin = laplacian_.rows();
  const Positions excess = laplacian_ * nodes.topRows(skin) - curvature;
  const Positions force = weight_.asDiagonal() * excess;
  gradient.topRows(skin) += laplacian_ * force;
  return 0.5 * excess.cwiseProduct(force).sum();
}

}  // namespace bodyopt::trainer
