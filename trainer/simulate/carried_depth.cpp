#include "trainer/simulate/carried_depth.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "geometry/closed_skin.h"
#include "geometry/point_grid.h"
#include "geometry/vertex_normals.h"

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
      nearest_(rest_skin_, triangles_),
      outwards_(vertex_normals(rest_skin_, triangles_)) {
  std::iota(vertices_.begin(), vertices_.end(), 0);
  if (enclosed_volume(rest_skin_, triangles_) < 0) outwards_ *= -1;
  const Eigen::Vector3d low = rest_skin_.colwise().minCoeff(), high = rest_skin_.colwise().maxCoeff();
  grid_.size = (high - low).maxCoeff() / kCubes;
  grid_.origin = low.array() - grid_.size / 2;
  grid_.count = ((high - low) / grid_.size).array().ceil().cast<int>() + 1;
  voxels_ = voxelise(rest_skin_, triangles_, grid_);
  if (!cage.is_lattice) return;
  tissue_.resize(static_cast<std::size_t>(tets_.rows()));
  double cube = 0;  // cubic metres
  for (const CageSample& sample : cage.samples) {
    tissue_[static_cast<std::size_t>(sample.point.tet)].push_back(rest_position(cage.mesh, sample.point));
    cube = std::max(cube, sample.volume);
  }
  sample_reach_ = std::cbrt(cube);
}

bool CarriedDepth::is_tissue(Eigen::Index tet, const Eigen::Vector3d& point) const {
  if (tissue_.empty()) return true;
  const std::vector<Eigen::Vector3d>& samples = tissue_[static_cast<std::size_t>(tet)];
  return std::any_of(samples.begin(), samples.end(), [&](const Eigen::Vector3d& sample) {
    return (sample - point).cwiseAbs().maxCoeff() < sample_reach_;
  });
}

// Of a point of the body at rest below the skin, metres; 0 outside.
double CarriedDepth::depth(const Eigen::Vector3d& point) const {
  const Eigen::Vector3i cube = grid_.cube_at(point);
  const Voxel voxel = grid_.contains(cube) ? voxels_[grid_.index(cube)] : Voxel::outside;
  if (voxel == Voxel::outside) return 0;
  const SkinPoint skin = nearest_(point);
  Eigen::RowVector3d outwards = Eigen::RowVector3d::Zero();
  for (int k = 0; k < 3; ++k) outwards += skin.weights[k] * outwards_.row(skin.vertices[static_cast<std::size_t>(k)]);
  const bool is_outside = voxel == Voxel::surface && outwards.dot((point - skin.position).transpose()) > 0;
  return is_outside ? 0 : (skin.position - point).norm();
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
      if ((point - rest_skin_.row(v)).norm() < same_part_[v] || !is_tissue(t, point)) return;
      deepest = std::max(deepest, depth(point));
    });
  }
  return deepest;
}

}  // namespace bodyopt
