// The rotation nearest to a matrix, by which point sets are aligned.
#pragma once

#include <Eigen/Core>

namespace bodyopt {

struct NearestRotation {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d stretches;  // singular values, descending; the last is negative where a reflection would be nearer
};

// In the Frobenius norm (Kabsch 1976, Umeyama 1991): of the sum of to * from^T the rotation that lays `from` best on
// `to`.
NearestRotation nearest_rotation(const Eigen::Matrix3d& matrix);

}  // namespace bodyopt
