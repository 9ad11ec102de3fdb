// The point of the skin nearest to a point in space.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "geometry/mesh.h"

namespace bodyopt {

class BoxTree;

struct SkinPoint {
  Eigen::Index triangle = -1;
  std::array<std::uint32_t, 3> vertices{};
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();  // barycentric, >= 0, sum 1
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
};

// Interpolates rows, or numbers, of a triangle's vertices at a point of the skin.
template <typename Rows>
Eigen::Matrix<double, 1, Rows::ColsAtCompileTime> at_point(const Eigen::MatrixBase<Rows>& rows, const SkinPoint& at) {
  Eigen::Matrix<double, 1, Rows::ColsAtCompileTime> sum =
      Eigen::Matrix<double, 1, Rows::ColsAtCompileTime>::Zero(rows.cols());
  for (int k = 0; k < 3; ++k) sum += at.weights[k] * rows.row(at.vertices[static_cast<std::size_t>(k)]);
  return sum;
}
inline double at_point(const Eigen::VectorXd& values, const SkinPoint& at) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += at.weights[k] * values[at.vertices[static_cast<std::size_t>(k)]];
  return sum;
}

// The weights of the joints at a point of the skin, ascending by joint, without those of corners that have no part in
// it.
std::vector<JointWeight> weights_at(const SkinWeights& weights, const SkinPoint& at);

// Exact nearest-triangle search through a tree of the triangles' boxes. There must be a triangle, and
// the arrays must outlive this. The first of equally near triangles wins.
class NearestSkin {
 public:
  NearestSkin(const Positions& vertices, const Triangles& triangles);
  ~NearestSkin();
  SkinPoint operator()(const Eigen::Vector3d& point) const;
  // Among triangles whose normal is less than 90 degrees from `normal`; triangle -1 where there is none.
  SkinPoint facing(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;

 private:
  template <typename Wanted>
  SkinPoint search(const Eigen::Vector3d& point, const Wanted& wanted) const;

  const Positions& vertices_;
  const Triangles& triangles_;
  double largest_coordinate_;
  std::unique_ptr<BoxTree> tree_;
};

}  // namespace bodyopt
