// What geometry is computed on: points, triangles, and how joints hold points.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace bodyopt {

using Positions = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;         // #V x 3
using Triangles = Eigen::Matrix<std::uint32_t, Eigen::Dynamic, 3, Eigen::RowMajor>;  // #T x 3

struct JointWeight {
  std::uint32_t joint;
  double weight;
};
using SkinWeights = std::vector<std::vector<JointWeight>>;  // V

// How much of their weights two vertices have in common: 1 where they follow the same joints alike, 0 of different
// ones.
double shared_weight(const std::vector<JointWeight>& a, const std::vector<JointWeight>& b);

}  // namespace bodyopt
