#include "trainer/muscle_models/align.h"

#include <cmath>

#include "base/linear_algebra.h"
#include "geometry/nearest_rotation.h"

namespace bodyopt::muscle_models {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Directions in which the points spread less than this part of their largest spread are left to the similarity.
constexpr double kThin = 0.1;

// 3 x n: the points relative to their mean.
Eigen::Matrix3Xd centred(const std::vector<Vector3d>& points, Vector3d& mean) {
  Eigen::Matrix3Xd matrix(3, points.size());
  for (std::size_t k = 0; k < points.size(); ++k) matrix.col(static_cast<Eigen::Index>(k)) = points[k];
  mean = matrix.rowwise().mean();
  return matrix.colwise() - mean;
}

}  // namespace

Alignment align(const std::vector<Vector3d>& from, const std::vector<Vector3d>& to, const Matrix3d& turn) {
  Vector3d from_mean, to_mean;
  const Eigen::Matrix3Xd a = centred(from, from_mean), b = centred(to, to_mean);
  const Vector3d from_line = from[1] - from[0], to_line = to[1] - to[0];
  // The least turn from the given one that takes the first line to its image decides what the points leave open.
  const Matrix3d open = least_turn(turn * from_line, to_line).toRotationMatrix() * turn;
  Alignment result;
  result.turn = nearest_rotation(b * a.transpose() + 1e-3 * a.norm() * b.norm() * open).rotation;
  const Matrix3d similarity = b.norm() / a.norm() * result.turn;

  const SymmetricEigen3 spread = symmetric_eigen_3(a * a.transpose());
  Vector3d inverse = spread.values;  // of squared spreads
  for (double& value : inverse) value = value > kThin * kThin * spread.values[2] ? 1 / value : 0;
  const Eigen::Matrix<double, Eigen::Dynamic, 3> pseudo_inverse =
      a.transpose() * spread.vectors * inverse.asDiagonal() * spread.vectors.transpose();
  const Matrix3d linear = similarity + (b - similarity * a) * pseudo_inverse;
  result.scale = std::cbrt(std::abs(linear.determinant()));
  result.map.linear() = linear;
  result.map.translation() = to_mean - linear * from_mean;
  return result;
}

}  // namespace bodyopt::muscle_models
