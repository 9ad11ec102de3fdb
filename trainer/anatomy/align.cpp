#include "trainer/anatomy/align.h"

#include <Eigen/SVD>
#include <cmath>

namespace bodyopt::anatomy {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Directions in which the points spread less than this part of their largest spread are left to the similarity.
constexpr double kThin = 0.1;

Matrix3d nearest_rotation(const Matrix3d& matrix) {
  const Eigen::JacobiSVD<Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
}

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
  const Matrix3d open = Eigen::Quaterniond::FromTwoVectors(turn * from_line, to_line).toRotationMatrix() * turn;
  Alignment result;
  result.turn = nearest_rotation(b * a.transpose() + 1e-3 * a.norm() * b.norm() * open);
  const Matrix3d similarity = b.norm() / a.norm() * result.turn;

  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(a, Eigen::ComputeThinU | Eigen::ComputeThinV);
  Eigen::VectorXd inverse = svd.singularValues();
  for (double& value : inverse) value = value > kThin * svd.singularValues()[0] ? 1 / value : 0;
  const Eigen::MatrixXd pseudo_inverse = svd.matrixV() * inverse.asDiagonal() * svd.matrixU().transpose();
  const Matrix3d linear = similarity + (b - similarity * a) * pseudo_inverse;
  result.scale = std::cbrt(std::abs(linear.determinant()));
  result.map.linear() = linear;
  result.map.translation() = to_mean - linear * from_mean;
  return result;
}

}  // namespace bodyopt::anatomy
