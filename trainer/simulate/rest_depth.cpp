#include "trainer/simulate/rest_depth.h"

#include "geometry/mend_surface.h"
#include "geometry/mesh.h"

namespace bodyopt::trainer {
namespace {

constexpr int kCubes = 100;  // along the body, to tell inside from outside quickly
// Metres: nearer to the skin the way to it has no direction, and its normal stands for it.
constexpr double kOnSkin = 1e-6;

}  // namespace

RestDepth::RestDepth(const Positions& skin, const Triangles& triangles)
    : skin_(skin), triangles_(triangles), outwards_(vertex_normals(skin_, triangles_)), nearest_(skin_, triangles_) {
  if (enclosed_volume(skin_, triangles_) < 0) outwards_ *= -1;
  const Eigen::Vector3d low = skin_.colwise().minCoeff(), high = skin_.colwise().maxCoeff();
  grid_.size = (high - low).maxCoeff() / kCubes;
  grid_.origin = low.array() - grid_.size / 2;
  grid_.count = ((high - low) / grid_.size).array().ceil().cast<int>() + 1;
  voxels_ = voxelise(skin_, triangles_, grid_);
}

Depth RestDepth::operator()(const Eigen::Vector3d& point) const {
  const SkinPoint skin = nearest_(point);
  const Eigen::Vector3d outwards = at_point(outwards_, skin).transpose(), way = point - skin.position;
  const Eigen::Vector3i cube = grid_.cube_at(point);
  const Voxel voxel = grid_.contains(cube) ? voxels_[grid_.index(cube)] : Voxel::outside;
  const bool is_inside = voxel == Voxel::surface ? outwards.dot(way) <= 0 : voxel == Voxel::inside;
  const double distance = way.norm(), side = is_inside ? 1 : -1;
  if (distance < kOnSkin) return {side * distance, -outwards.normalized()};
  return {side * distance, side / distance * way};
}

}  // namespace bodyopt::trainer
