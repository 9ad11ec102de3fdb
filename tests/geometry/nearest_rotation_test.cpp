#include "geometry/nearest_rotation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

namespace bodyopt::testing {
namespace nearest_rotation_test {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d random_matrix(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Matrix3d::NullaryExpr([&] { return normal(random); });
}

TEST(NearestRotation, FindsTheTurnUnderAStretch) {
  const Matrix3d turn = Eigen::AngleAxisd(1.3, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const Matrix3d other = Eigen::AngleAxisd(-0.6, Vector3d(1, 0, 3).normalized()).toRotationMatrix();
  const Vector3d sizes(3, 2, 0.5);
  const NearestRotation found = nearest_rotation(turn * other * sizes.asDiagonal() * other.transpose());
  EXPECT_LT((found.rotation - turn).norm(), 1e-12);
  EXPECT_LT((found.stretches - sizes).norm(), 1e-12);
}

// No turn of it by a little is nearer, also where the nearest orthogonal matrix is a reflection.
TEST(NearestRotation, IsNearestAndNeverAReflection) {
  std::mt19937_64 random(3);
  for (int k = 0; k < 50; ++k) {
    const Matrix3d matrix = random_matrix(random);
    const NearestRotation found = nearest_rotation(matrix);
    EXPECT_NEAR(found.rotation.determinant(), 1, 1e-12);
    EXPECT_LT((found.rotation.transpose() * found.rotation - Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_EQ(found.stretches[2] < 0, matrix.determinant() < 0);
    for (const Vector3d& axis : {Vector3d::UnitX().eval(), Vector3d::UnitY().eval(), Vector3d::UnitZ().eval()}) {
      for (const double angle : {-0.1, 0.1, 1.0, 3.0}) {
        const Matrix3d turned = Eigen::AngleAxisd(angle, axis) * found.rotation;
        EXPECT_LE((matrix - found.rotation).norm(), (matrix - turned).norm());
      }
    }
  }
}

}  // namespace nearest_rotation_test
}  // namespace bodyopt::testing
