#include "shaders/include/rotation.h"

#include <gtest/gtest.h>

#include <functional>

#include "tests/support/random_tables.h"
#include "tests/support/textbook_ddm.h"

namespace bodyopt::testing {
namespace {

using Matrix = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;

Eigen::Matrix3d run_rot(const Matrix& matrix) {
  float a[9], r[9];
  std::copy(matrix.data(), matrix.data() + 9, a);
  rot(a, r);
  return Eigen::Map<const Matrix>(r).cast<double>();
}

void expect_rotation(const Eigen::Matrix3d& r, const Matrix& of) {
  ASSERT_TRUE(r.allFinite()) << of;
  ASSERT_LT((r * r.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-6) << of;
  ASSERT_NEAR(r.determinant(), 1, 1e-6) << of;
}

Eigen::Matrix3d random_rotation(Random& random) {
  const auto q = random.turn(3.14159);
  return Eigen::Quaterniond(q[3], q[0], q[1], q[2]).toRotationMatrix();
}

// U diag(s) V^T with random U, V.
Matrix with_singular_values(Random& random, double s0, double s1, double s2) {
  const Eigen::Matrix3d u = random_rotation(random), v = random_rotation(random);
  return (u * Eigen::Vector3d(s0, s1, s2).asDiagonal() * v.transpose()).cast<float>();
}

// Rotations always; the nearest one, to the precision that the gap allows, where there is one.
TEST(Rotation, IsNearestForAllKindsOfMatrices) {
  Random random(7);
  const std::vector<std::function<Matrix()>> kinds = {
      [&] {
        return with_singular_values(random, random.uniform(0.1, 1), random.uniform(0.1, 1), random.uniform(0.1, 1));
      },
      [&] { return with_singular_values(random, 1, random.uniform(0.3, 1), -random.uniform(0, 0.25)); },  // det < 0
      [&] { return with_singular_values(random, 1, random.uniform(0.1, 1), 0); },                         // flat
      [&] { return with_singular_values(random, 1, 1, random.uniform(0, 1)); },          // a double value
      [&] { return with_singular_values(random, 1, 0.1, random.uniform(0, 0.1)); },      // nearly a line
      [&] { return with_singular_values(random, 1, 0.9, -random.uniform(0.7, 0.85)); },  // nearly a reflection
      [&] { return Matrix(random_rotation(random).cast<float>()); },
      [&] { return Matrix(with_singular_values(random, 1, 0.7, 0.4) * 1e-25f); },
      [&] { return Matrix(with_singular_values(random, 1, 0.7, 0.4) * 1e25f); },
  };
  for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
    double worst = 0;
    for (int i = 0; i < 2000; ++i) {
      const Matrix a = kinds[kind]();
      const Eigen::Matrix3d r = run_rot(a);
      expect_rotation(r, a);
      const Eigen::Matrix3d exact = a.cast<double>();
      const double gap = rotation_gap(exact);
      if (gap < 0.05) continue;
      worst = std::max(worst, gap * (r - nearest_rotation(exact)).norm());
      // The error is a few roundings over the gap.
      ASSERT_LT(gap * (r - nearest_rotation(exact)).norm(), 4e-6) << "kind " << kind << ", gap " << gap << "\n" << a;
    }
    RecordProperty("worst_of_kind_" + std::to_string(kind), std::to_string(worst));
  }
}

// Where any rotation of a family is as near, one of them: tr(R^T A) reaches the sum of the signed singular values.
TEST(Rotation, IsOptimalWhereItIsNotUnique) {
  Random random(11);
  for (int i = 0; i < 3000; ++i) {
    const Matrix a = i % 3 == 0   ? with_singular_values(random, 1, 0, 0)        // rank 1
                     : i % 3 == 1 ? with_singular_values(random, 1, 1, -1)       // a reflection
                                  : with_singular_values(random, 1, 0.5, -0.5);  // a reflection of a disc
    const Eigen::Matrix3d r = run_rot(a), exact = a.cast<double>();
    expect_rotation(r, a);
    ASSERT_NEAR((r.transpose() * exact).trace(), (nearest_rotation(exact).transpose() * exact).trace(), 1e-3)
        << "case " << i % 3 << "\n"
        << a;
  }
}

TEST(Rotation, DegenerateMatricesGiveRotations) {
  expect_rotation(run_rot(Matrix::Zero()), Matrix::Zero());
  for (const float scale : {1e-38f, 1e-30f, 1e-20f, 1.0f, 1e20f, 3e38f}) {
    for (int entry = 0; entry < 9; ++entry) {
      for (const float sign : {1.0f, -1.0f}) {
        Matrix a = Matrix::Zero();
        a.data()[entry] = sign * scale;
        expect_rotation(run_rot(a), a);
        a = Matrix::Constant(sign * scale);
        expect_rotation(run_rot(a), a);
        a = Matrix::Identity() * (sign * scale);
        expect_rotation(run_rot(a), a);
        a.data()[entry] *= -1;
        expect_rotation(run_rot(a), a);
      }
    }
  }
}

}  // namespace
}  // namespace bodyopt::testing
