// The affine map that takes some points to others.
#pragma once

#include <Eigen/Geometry>
#include <vector>

namespace bodyopt::muscle_models {

struct Alignment {
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  // its rotation
  double scale = 1;                                    // of lengths, the mean over all directions
};

// The best similarity from `from` to `to` (two points or more, the first two apart), corrected by the smallest linear
// map that takes the points exactly; where they are too many or too nearly on a line for that, as well as it does.
// `turn` is what it is turned by where the points leave that open.
Alignment align(const std::vector<Eigen::Vector3d>& from, const std::vector<Eigen::Vector3d>& to,
                const Eigen::Matrix3d& turn);

}  // namespace bodyopt::muscle_models
