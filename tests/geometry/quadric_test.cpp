#include "geometry/quadric.h"

#include <gtest/gtest.h>

namespace bodyopt {
namespace {

TEST(Quadric, IsTheWeightedSumOfSquaredDistances) {
  const Eigen::Vector3d normals[] = {Eigen::Vector3d(1, 2, -2) / 3, Eigen::Vector3d(0.6, 0, 0.8), {0, -1, 0}};
  const double offsets[] = {0.5, -0.25, 2}, weights[] = {0.1, 3, 1};
  Quadric first, second;
  for (int k = 0; k < 3; ++k) (k < 2 ? first : second).add_plane(normals[k], offsets[k], weights[k]);
  Quadric all = first;
  all += second;
  for (const Eigen::Vector3d& x :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, -2, 0.3), Eigen::Vector3d(-4, 0.1, 7)}) {
    double expected = 0;
    for (int k = 0; k < 3; ++k) expected += weights[k] * std::pow(normals[k].dot(x) + offsets[k], 2);
    EXPECT_NEAR(all.at(x), expected, 1e-12 * expected);
  }
}

}  // namespace
}  // namespace bodyopt
