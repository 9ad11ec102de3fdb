#include "trainer/simulate/carried_depth.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "trainer/simulate/point_grid.h"

namespace bodyopt {
namespace {

constexpr double kSamePart = 1.5;  // edges of the skin
constexpr int kCubes = 100;        // along the body, to tell inside from outside quickly

// Per vertex, the mean edge around it, metres.
Eigen::VectorXd edges_around(const Character& character) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(character.vertices.rows()), count = sum;
  for (Eigen::Index t = 0; t < character.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto a = character.triangles(t, k), b = character.triangles(t, (k + 1) % 3);
      const double edge = (character.vertices.row(a) - character.vertices.row(b)).norm();
      for (const auto v : {a, b}) {
        sum[v] += edge;
        count[v] += 1;
      }
    }
  }
  return sum.cwiseQuotient(count.cwiseMax(1));
}

}  // namespace

CarriedDepth::CarriedDepth(const Character& character, const Cage& cage)
    : tets_(cage.mesh.tets),
      rest_nodes_(cage.mesh.nodes),
      rest_skin_(character.vertices),
      triangles_(character.triangles),
      skin_(cage.skin),
      vertices_(cage.skin.size()),
      same_part_(kSamePart * edges_around(character)),
      cell_(2 * same_part_.mean()),
      depth_(rest_skin_, triangles_) {
  std::iota(vertices_.begin(), vertices_.end(), 0);
  const Eigen::Vector3d low = rest_skin_.colwise().minCoeff(), high = rest_skin_.colwise().maxCoeff();
  grid_.size = (high - low).maxCoeff() / kCubes;
  grid_.origin = low.array() - grid_.size / 2;
  grid_.count = ((high - low) / grid_.size).array().ceil().cast<int>() + 1;
  voxels_ = voxelise(rest_skin_, triangles_, grid_);
}

// The depth of a point of the body at rest, or `least` where it is not deeper.
double CarriedDepth::depth_beyond(double least, const Eigen::Vector3d& point) const {
  const Eigen::Vector3i cube = grid_.cube_at(point);
  const Voxel voxel = grid_.contains(cube) ? voxels_[grid_.index(cube)] : Voxel::outside;
  if (voxel == Voxel::outside) return least;
  const double distance = depth_.distance(point);
  if (distance <= least) return least;
  return voxel == Voxel::inside ? distance : std::max(depth_(point), least);
}

double CarriedDepth::deepest(const Positions& nodes) const {
  const Positions skin = embed(skin_, tets_, nodes);
  const PointGrid grid(skin, vertices_, cell_);
  double deepest = 0;
  for (Eigen::Index t = 0; t < tets_.rows(); ++t) {
    const Positions corners = nodes(tets_.row(t), Eigen::all), rest = rest_nodes_(tets_.row(t), Eigen::all);
    const Eigen::RowVector3d origin = corners.row(0);
    const Eigen::Matrix3d edges = (corners.bottomRows<3>().rowwise() - origin).transpose();
    if (!(edges.determinant() > 0)) continue;
    const Eigen::Matrix3d inverse = edges.inverse();
    grid.visit(corners.colwise().minCoeff(), corners.colwise().maxCoeff(), [&](int v) {
      Eigen::RowVector4d weights;
      weights.tail<3>() = (inverse * (skin.row(v) - origin).transpose()).transpose();
      weights[0] = 1 - weights.tail<3>().sum();
      if (!(weights.minCoeff() >= 0)) return;
      const Eigen::RowVector3d point = weights * rest;
      if ((point - rest_skin_.row(v)).norm() < same_part_[v]) return;
      deepest = depth_beyond(deepest, point.transpose());
    });
  }
  return deepest;
}

}  // namespace bodyopt
