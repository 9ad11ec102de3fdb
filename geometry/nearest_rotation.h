// The rotation nearest to a matrix, by which point sets are aligned.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace bodyopt {

struct NearestRotation {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d stretches;  // singular values, descending; the last is negative where a reflection would be nearer
};

// It minimises the Frobenius norm (Kabsch 1976, Umeyama 1991). For the sum of to * from^T it lays `from` best on `to`.
NearestRotation nearest_rotation(const Eigen::Matrix3d& matrix);

// The shortest turn of one direction to another; where they are opposite, about any axis across.
Eigen::Quaterniond least_turn(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace bodyopt
