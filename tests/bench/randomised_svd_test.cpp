#include "bench/randomised_svd.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>

namespace bodyopt::bench {
namespace {

// Singular values that fall by a fifth each: what is left beyond rank 12 is nearly the least possible.
TEST(RandomisedSvd, IsNearlyTheBestOfItsRank) {
  constexpr Eigen::Index kRank = 12;
  std::srand(1);
  const Eigen::BDCSVD<Eigen::MatrixXf> random(Eigen::MatrixXf::Random(80, 300),
                                              Eigen::ComputeThinU | Eigen::ComputeThinV);
  Eigen::VectorXf singular(80);
  for (Eigen::Index k = 0; k < 80; ++k) singular[k] = std::pow(0.8f, static_cast<float>(k));
  const RowMajorMatrix matrix = random.matrixU() * singular.asDiagonal() * random.matrixV().transpose();
  const Svd svd = randomised_svd(matrix, kRank, 1);
  ASSERT_EQ(svd.u.cols(), kRank);
  EXPECT_LT((svd.u.transpose() * svd.u - Eigen::MatrixXf::Identity(kRank, kRank)).norm(), 1e-4);
  EXPECT_LT((svd.v.transpose() * svd.v - Eigen::MatrixXf::Identity(kRank, kRank)).norm(), 1e-4);
  EXPECT_LT((svd.singular - singular.head(kRank)).norm(), 1e-3);
  const float left = (matrix - svd.u * svd.singular.asDiagonal() * svd.v.transpose()).norm();
  EXPECT_LT(left, 1.02f * singular.tail(80 - kRank).norm());
}

}  // namespace
}  // namespace bodyopt::bench
